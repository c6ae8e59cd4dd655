"""Did it happen at an instant, or is it what a load that wanders makes by chance? And when?

A slow load has bends, and a step laid over the highest of them lowers error and innovations alike: noise
whose long memory a short autoregression does not hold is explained a little everywhere. So the best instant
is compared with the best instants of surrogates of the innovations, which have their spectrum and phases by
chance (Theiler and others, Physica D 58 (1992) 77): what is a matter of spectrum is in them as well, and
what happened once is not. Nothing is refitted; what a move of any parameter would do is projected out first.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple, cast

import numpy as np

from agent.analysis.stiction.shapes.phase_surrogates import surrogates
from agent.physics.loop_model import LoopModel
from agent.workbench.residual.movable import beyond, movable
from agent.workbench.search import hypercube
from agent.workbench.space import space_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from agent.analysis.record.recording import FloatArray
    from agent.physics.effect import DisturbanceEffect, Effect
    from agent.workbench.predictor import Predictor

SCAN = 1500
"""Values of the effect that are looked at."""
SURROGATES = 199
LEAST_NEW = 0.03
"""Part of the length of what an effect adds that the model could not move to as well."""
APART = 1e-3
"""Part of its square that an instant adds beside the first, to be another."""
GUMBEL_SCALE = math.sqrt(6.0) / math.pi


class Best(NamedTuple):
    """The best instants of each of d series, one after the other."""

    explained: FloatArray
    """Squares, by all of them, (d,)."""
    places: NDArray[np.intp]
    """Which of the values, (instants, d)."""


@dataclass(frozen=True, slots=True)
class Scan:
    """What one instant of an effect adds to the innovations of a model without it, for many values."""

    left: FloatArray
    """The innovations, what the model may move to projected out, PV units, (m,)."""
    known: FloatArray
    """Orthonormal columns of the latter, (m, q)."""
    values: FloatArray
    """Of the effect, own units, (a, k); all its instants are the same."""
    atoms: FloatArray
    """What it adds, of length one, (m, a)."""
    instants: tuple[int, ...]
    """Which of the values are instants."""

    def best(self, series: FloatArray) -> Best:
        """Return what explains most of each of some innovations, (m, d)."""
        along = self.atoms.T @ series
        new = np.ones_like(along)
        taken: list[FloatArray] = []
        explained, places = np.zeros(series.shape[1]), []
        for _ in self.instants:
            share = np.where(new > APART, along**2, 0.0) / np.maximum(new, APART)
            place = np.argmax(share, axis=0)
            explained += np.take_along_axis(share, place[None, :], axis=0)[0]
            places.append(place)
            # Gram and Schmidt: what this one adds beside those that were taken before.
            atom = self.atoms[:, place]
            for other in taken:
                atom = atom - other * np.einsum("ij,ij->j", other, atom)
            atom = atom / np.maximum(np.linalg.norm(atom, axis=0), np.sqrt(APART))
            taken.append(atom)
            alike = self.atoms.T @ atom
            along = along - alike * np.einsum("ij,ij->j", atom, series)
            new = new - alike**2
        return Best(explained, np.array(places))


def instant_p(predicts: Predictor, best: FloatArray, effect: Effect) -> float:
    """Return how likely an effect that happened once explains as much where nothing happened.

    The largest of many has Gumbel's distribution: its mean and deviation are those of the surrogates.

    Args:
        predicts: Of the model without the effect.
        best: The point of the unit cube where its predictions are best, (k,).
        effect: A disturbance with instants.
    """
    scan = _scan(predicts, best, effect)
    if not len(scan.values):
        return 1.0
    seen = float(scan.best(scan.left[:, None]).explained[0])
    by_chance = scan.best(beyond(surrogates(scan.left, SURROGATES, 0).T, scan.known)).explained
    return _tail(seen, by_chance)


def _tail(seen: float, by_chance: FloatArray) -> float:
    """Return how likely the largest of many is at least ``seen``, as those of the surrogates (d,) scatter."""
    scale = GUMBEL_SCALE * max(float(by_chance.std()), np.finfo(float).tiny)
    mode = float(by_chance.mean()) - np.euler_gamma * scale
    return -math.expm1(-math.exp(-min(max((seen - mode) / scale, -50.0), 700.0)))


def instants_seen(predicts: Predictor, best: FloatArray, effect: Effect) -> FloatArray:
    """Return values of an effect, own units, (m, k), that place it where the innovations show it.

    A free run's residual does not show it there: the controller has answered, and much of it is gone.
    """
    scan = _scan(predicts, best, effect)
    if not len(scan.values):
        return scan.values
    spots = scan.values[scan.best(scan.left[:, None]).places[:, 0]]
    spots[:, scan.instants] = np.diag(spots[:, scan.instants])
    return spots


def _scan(predicts: Predictor, best: FloatArray, effect: Effect) -> Scan:
    objective = predicts.objective
    record, layout, values = objective.record, objective.layout, objective.space.values(best)
    response = layout.response(layout.position(record.op, values), values)
    space = space_of(LoopModel(objective.model.base, (effect,)), record.facts)
    own = len(space) - len(effect.parameters(record.facts))
    points = hypercube(SCAN, len(space))
    instants = [i for i, each in enumerate(space.parameters) if each.instant]
    points[:, instants] = points[:, instants[:1]]
    tried = space.values(points)[:, own:]
    time = np.asarray(record.facts.ts * np.arange(len(record)), dtype=np.float64)
    columns = cast("DisturbanceEffect", effect).columns
    added = np.column_stack([columns(time, response, each)[:, 0] for each in tried])
    known = movable(predicts, best)
    white = predicts.noise.filtered(added)[predicts.kept]
    length = np.linalg.norm(white, axis=0)
    new = beyond(white, known)
    size = np.linalg.norm(new, axis=0)
    seen = size > LEAST_NEW * length
    atoms = np.asarray(new[:, seen] / size[seen], dtype=np.float64)
    left = beyond(predicts.residual(best), known)
    return Scan(left, known, tried[seen], atoms, tuple(i - own for i in instants))
