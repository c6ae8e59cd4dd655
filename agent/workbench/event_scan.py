"""Did it happen at an instant, or is it what a load that wanders makes by chance?

A slow load has bends, and a step laid over the highest of them lowers error and innovations alike: noise
whose long memory a short autoregression does not hold is explained a little everywhere. So the best instant
is compared with the best instants of surrogates of the innovations, which have their spectrum and phases by
chance (Theiler and others, Physica D 58 (1992) 77): what is a matter of spectrum is in them as well, and
what happened once is not. Nothing is refitted; what a move of any parameter would do is projected out first.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, cast

import numpy as np

from agent.analysis.stiction.phase_surrogates import surrogates
from agent.physics.loop_model import LoopModel
from agent.workbench.search import hypercube
from agent.workbench.space import space_of
from agent.workbench.state_dependence import directions, left_of_start

if TYPE_CHECKING:
    from agent.analysis.recording import FloatArray
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


def instant_p(predicts: Predictor, best: FloatArray, effect: Effect) -> float:
    """Return how likely an effect that happened once explains as much where nothing happened.

    The largest of many has Gumbel's distribution: its mean and deviation are those of the surrogates.

    Args:
        predicts: Of the model without the effect, on a linear base.
        best: The point of the unit cube where its predictions are best, (k,).
        effect: A disturbance with instants.
    """
    known = _known(predicts, best)
    left = _beyond(predicts.residual(best), known)
    atoms = _atoms(predicts, best, effect, known)
    if not atoms.shape[1]:
        return 1.0
    instants = sum(each.instant for each in effect.parameters(predicts.objective.record.facts))
    drawn = _beyond(surrogates(left, SURROGATES, 0).T, known)
    explained = _explained(np.column_stack((left, drawn)), atoms, instants)
    seen, by_chance = explained[0], explained[1:]
    scale = GUMBEL_SCALE * max(float(by_chance.std()), np.finfo(float).tiny)
    mode = float(by_chance.mean()) - np.euler_gamma * scale
    return -math.expm1(-math.exp(-min(max((seen - mode) / scale, -50.0), 700.0)))


def _known(predicts: Predictor, best: FloatArray) -> FloatArray:
    """Return orthonormal columns of what the model may move to, (m, q)."""
    own = np.column_stack((predicts.objective.columns(best), left_of_start(predicts.objective.record)))
    white = predicts.noise.filtered(own)[predicts.kept]
    return directions(np.column_stack((predicts.derivative(best), white, predicts.basis)))


def _beyond(columns: FloatArray, known: FloatArray) -> FloatArray:
    return np.asarray(columns - known @ (known.T @ columns), dtype=np.float64)


def _atoms(predicts: Predictor, best: FloatArray, effect: Effect, known: FloatArray) -> FloatArray:
    """Return what one instant adds to the innovations, for many values, columns of length one, (m, a)."""
    objective = predicts.objective
    record, layout, values = objective.record, objective.layout, objective.space.values(best)
    response = layout.response(layout.position(record.op, values), values)
    space = space_of(LoopModel(objective.model.base, (effect,)), record.facts)
    own = len(effect.parameters(record.facts))
    points = hypercube(SCAN, len(space))
    instants = [i for i, each in enumerate(space.parameters) if each.instant]
    points[:, instants] = points[:, instants[:1]]
    time = np.asarray(record.facts.ts * np.arange(len(record)), dtype=np.float64)
    columns = cast("DisturbanceEffect", effect).columns
    added = [columns(time, response, each[-own:])[:, 0] for each in space.values(points)]
    white = predicts.noise.filtered(np.column_stack(added))[predicts.kept]
    length = np.linalg.norm(white, axis=0)
    new = _beyond(white, known)
    size = np.linalg.norm(new, axis=0)
    told = size > LEAST_NEW * length
    return np.asarray(new[:, told] / size[told], dtype=np.float64)


def _explained(series: FloatArray, atoms: FloatArray, instants: int) -> FloatArray:
    """Return the squares that the best instant, and with two the best beside it, explain of each, (d,).

    Args:
        series: (m, d).
        atoms: (m, a).
        instants: More than two count as two.
    """
    along = atoms.T @ series
    first = np.argmax(along**2, axis=0)
    best = np.take_along_axis(along, first[None, :], axis=0)[0]
    explained = best**2
    if instants > 1:
        alike = atoms.T @ atoms[:, first]
        new = 1 - alike**2
        beside = (along - alike * best) ** 2
        explained = explained + np.max(np.where(new > APART, beside, 0.0) / np.maximum(new, APART), axis=0)
    return np.asarray(explained, dtype=np.float64)
