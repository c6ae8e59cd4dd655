"""From many rough points to the least free-run error: a scan, then local searches from the best.

The error has several basins, so that one start is not enough. From each, steps of Gauss and Newton; then a
simplex where the error itself has steps or kinks, at a slip, a stop or an event.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from scipy.stats.qmc import LatinHypercube

from agent.workbench.gauss_newton import lowest
from agent.workbench.library import instants
from agent.workbench.nuisance import nuisance_of
from agent.workbench.projection import ProjectedPv, Solved, least_error, solve, target_behind, target_itself
from agent.workbench.simplex import lowered_by_simplex
from agent.workbench.space import Space, space_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from agent.analysis.record.recording import FloatArray
    from agent.identify.noise.autoregression import Innovations
    from agent.physics.effect import Facts
    from agent.physics.loop_model import Layout, LoopModel
    from agent.workbench.record import Record

Round = tuple[int, float, int]
"""Points kept, first step of the local search, its evaluations for each parameter."""
COARSE, SMOOTH = 1e-3, 1e-5
"""Step of derivatives, part of a parameter's range: over steps of the error, and where there are none."""
STEPS = 12
"""Of Gauss and Newton, at most, on a linear base."""
BALANCE_STEPS = 60
"""The same on a balance, whose time constants may be far from where the search begins."""
SAME = 0.1
"""Difference of points, twice a logarithm of their likelihoods, below which none is better."""
STEP = 0.05
"""First step of a simplex, part of a parameter's range."""


@dataclass(frozen=True, slots=True)
class Objective:
    """The free-run error of a model on some samples of a record."""

    model: LoopModel
    record: Record
    layout: Layout
    target: ProjectedPv
    space: Space

    @property
    def facts(self) -> Facts:
        """Of the record."""
        return self.record.facts

    @property
    def count(self) -> int:
        """Samples that count."""
        return self.target.count

    def columns(self, at: FloatArray) -> FloatArray:
        """Return the columns of the model at a point of the unit cube, (k,)."""
        return self.layout.columns(self.record.op, self.space.values(at))

    def solved(self, at: FloatArray) -> Solved:
        """Return the best coefficients at a point of the unit cube, (k,)."""
        return solve(self.columns(at), self.target)

    def residual(self, at: FloatArray) -> FloatArray:
        """Return what the best coefficients leave at a point of the unit cube, PV units, (n,)."""
        return self.solved(at).residual

    def error(self, at: FloatArray) -> float:
        """Return the sum of squares, PV units squared."""
        return _error(self.columns(at), self.target)

    @property
    def rough(self) -> bool:
        """Whether the error has steps or kinks: a slip, a stop or an event at another sample."""
        return any(each.stage == "valve" or instants(each, self.facts) > 0 for each in self.model.effects)


@dataclass(frozen=True, slots=True)
class Whitened(Objective):
    """The error of a model's one-step predictions, its residual taken to be autoregressive.

    ``target`` is of the whitened record: ``whitened``.
    """

    noise: Innovations

    def columns(self, at: FloatArray) -> FloatArray:
        """Return the whitened columns at a point of the unit cube, (k,); zero before the first prediction."""
        return self.noise.filtered(Objective.columns(self, at), before=0.0)


@dataclass(frozen=True, slots=True)
class Pinned:
    """An objective of which some coordinates and coefficients stay; points are of the other coordinates."""

    objective: Objective
    at: FloatArray
    """All coordinates, (k,)."""
    free: NDArray[np.bool_]
    """Which of them move, (k,)."""
    coefficients: FloatArray
    """Of all columns, (c,)."""
    solved_for: NDArray[np.bool_]
    """Which of them are solved for, (c,)."""

    @property
    def model(self) -> LoopModel:
        """Of the objective."""
        return self.objective.model

    @property
    def facts(self) -> Facts:
        """Of the objective's record."""
        return self.objective.facts

    @property
    def count(self) -> int:
        """Samples of the objective that count."""
        return self.objective.count

    @property
    def rough(self) -> bool:
        """Whether the objective is."""
        return self.objective.rough

    def whole(self, free: FloatArray) -> FloatArray:
        """Return all coordinates, (k,), of those that move."""
        point = self.at.copy()
        point[self.free] = free
        return point

    def solved(self, free: FloatArray) -> Solved:
        """Return the best coefficients at a point, those that stay among them."""
        columns, target = self._posed(free)
        found = solve(columns, target)
        coefficients = self.coefficients.copy()
        coefficients[self.solved_for] = found.coefficients
        return replace(found, coefficients=coefficients)

    def error(self, free: FloatArray) -> float:
        """Return the sum of squares, PV units squared."""
        return _error(*self._posed(free))

    def _posed(self, free: FloatArray) -> tuple[FloatArray, ProjectedPv]:
        """Return the columns that are solved for, and PV less the others."""
        columns, target = self.objective.columns(self.whole(free)), self.objective.target
        if self.solved_for.all():
            return columns, target
        known = (columns[:, ~self.solved_for] @ self.coefficients[~self.solved_for]) * target.weight
        known -= target.basis @ (target.basis.T @ known)
        sign = target.gain_sign if self.solved_for[0] else 0  # else no column is the response
        return columns[:, self.solved_for], replace(target, pv=target.pv - known, gain_sign=sign)


def _error(columns: FloatArray, target: ProjectedPv) -> float:
    """Return the sum of squares that ``columns`` (n, c) leave with their best coefficients."""
    return solve(columns, target).error if target.fixed_gain else least_error(columns, target)


def objective_of(model: LoopModel, record: Record, target: ProjectedPv) -> Objective:
    """Return what the search lowers."""
    return Objective(model, record, model.layout(record.facts), target, space_of(model, record.facts))


def whitened(objective: Objective, noise: Innovations) -> Whitened:
    """Return the same behind the filter of an autoregression; samples count that have all it needs."""
    record, order = objective.record, len(noise.coefficients)
    counted = np.convolve(objective.target.weight, np.ones(order + 1))[: len(record)] > order + 0.5
    weight, sign, pv = counted.astype(np.float64), record.facts.gain_sign, noise.filtered(record.pv)
    pv[:order] = 0.0
    if objective.target.fixed_gain:
        target = target_itself(pv, weight, sign)
    else:
        drift = noise.filtered(nuisance_of(record))
        drift[:order] = 0.0
        # An autoregression nearly takes a level off, yet what remains of it counts as any other.
        drift /= np.linalg.norm(drift, axis=0)
        target = target_behind(pv, drift, weight, sign)
    return Whitened(objective.model, record, objective.layout, target, objective.space, noise)


def of_last_effect(objective: Objective) -> NDArray[np.bool_]:
    """Return which coordinates are the last effect's, (k,); all where the model has none."""
    effects = objective.model.effects
    return (
        of_effect(objective, effects[-1].name) if effects else np.ones(len(objective.space), dtype=np.bool_)
    )


def of_effect(objective: Objective, name: str) -> NDArray[np.bool_]:
    """Return which coordinates are those of the effect of that name, (k,)."""
    return np.array([each.partition(".")[0] == name for each in objective.space.names], dtype=np.bool_)


def hypercube(points: int, size: int) -> FloatArray:
    """Return ``points`` points spread over the unit cube, (points, size); always the same."""
    if size == 0:
        return np.empty((points, 0))
    return np.asarray(LatinHypercube(size, rng=np.random.default_rng(0)).random(points), dtype=np.float64)


def spread_about(
    at: FloatArray, free: NDArray[np.bool_], moved: tuple[float, float], points: int
) -> FloatArray:
    """Return points of the unit cube, (``points``, k), always the same.

    The ``free`` coordinates, (k,), are spread; the others are as ``at`` (k,) has them, and in half of the
    points about half of them are off by something within ``moved``.
    """
    found = np.tile(at, (points, 1))
    found[:, free] = hypercube(points, int(free.sum()))
    others = found[points // 2 :, ~free]
    off = np.random.default_rng(0).uniform(*moved, others.shape)
    found[points // 2 :, ~free] = others + off * (hypercube(*others.shape) < 0.5)
    return np.clip(found, 0.0, 1.0)


def best_of(objective: Objective | Pinned, starts: FloatArray, count: int) -> list[FloatArray]:
    """Return the ``count`` best of ``starts`` (m, k) that differ, best first.

    Of those that are as good one is kept: searches that began apart often end in one valley, and an effect
    that does nothing does so at many of its values.
    """
    errors = [objective.error(each) for each in starts]
    flat = SAME / objective.count * min(errors, default=0.0)
    kept: list[int] = []
    for i in sorted(range(len(errors)), key=errors.__getitem__):
        if not kept or errors[i] - errors[kept[-1]] > flat:
            kept.append(i)
    return [starts[i] for i in kept[:count]]


def lowered(objective: Objective | Pinned, start: FloatArray, step: float, evaluations: int) -> FloatArray:
    """Return the best point of a local search from ``start`` (k,); ``evaluations`` for each parameter."""
    found = by_slopes(objective, start)
    if not len(start) or not objective.model.base.linear or not objective.rough:
        return found
    flat = SAME / objective.count * max(objective.error(found), 1e-300)
    return lowered_by_simplex(objective.error, found, step, evaluations, near=1.0, flat=flat)


def by_slopes(objective: Objective | Pinned, start: FloatArray) -> FloatArray:
    """Return the best point that steps of Gauss and Newton find from ``start`` (k,)."""
    if not len(start):
        return start
    if objective.model.base.linear:
        return lowest(lambda at: objective.solved(at).residual, start, STEPS, COARSE)
    flat = SAME / objective.count  # its numbers may go on for long where the record says little of them
    return lowest(lambda at: objective.solved(at).residual, start, BALANCE_STEPS, SMOOTH, flat)


def searched(objective: Objective | Pinned, starts: FloatArray, rounds: Sequence[Round]) -> FloatArray:
    """Return the best point of local searches from the best of ``starts`` (m, k).

    Which of many is the best the slopes show, but for the instant of a new event, which has none.

    Args:
        objective: What is lowered.
        starts: Points of the unit cube.
        rounds: One after the other, the first by slopes where these are enough.
    """
    points = list(starts)
    event = any(instants(each, objective.facts) for each in objective.model.effects[-1:])
    for k, (kept, step, evaluations) in enumerate(rounds):
        best = best_of(objective, np.array(points), kept)
        if k == 0 and not event:
            points = [by_slopes(objective, each) for each in best]
        else:
            points = [lowered(objective, each, step, evaluations) for each in best]
    return best_of(objective, np.array(points), 1)[0]
