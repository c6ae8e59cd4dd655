"""What a search lowers: the squares that a model leaves of PV, in free run or of its one-step predictions.

Most points of a search are needed several at a time. ``errors`` and ``residuals`` take them together, for
around a single one numpy and Python take as long as the work.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from agent.workbench.library import instants
from agent.workbench.nuisance import nuisance_of
from agent.workbench.projection import (
    ProjectedPv,
    Solved,
    errors_of,
    residuals_of,
    solve,
    target_behind,
    target_itself,
)
from agent.workbench.space import Space, space_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from agent.analysis.record.recording import FloatArray
    from agent.identify.noise.autoregression import Innovations
    from agent.physics.effect import Facts
    from agent.physics.loop_model import Layout, LoopModel
    from agent.workbench.record import Record

AT_ONCE = 32
"""Points whose columns stand in memory together."""


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
        """Return the columns of the model at a point of the unit cube, (k,); column by column in memory."""
        return np.asarray(self.rows(at[np.newaxis])[0].T)

    def rows(self, points: FloatArray) -> FloatArray:
        """Return the columns as rows, (m, c, n), at points of the unit cube, (m, k)."""
        return self.layout.rows(self.record.op, self.space.values(points))

    def solved(self, at: FloatArray) -> Solved:
        """Return the best coefficients at a point of the unit cube, (k,)."""
        return solve(self.columns(at), self.target)

    def residuals(self, points: FloatArray) -> FloatArray:
        """Return what the best coefficients leave at points, (m, k), each a row, PV units, (m, n)."""
        return residuals_of(self.rows(points), self.target)

    def error(self, at: FloatArray) -> float:
        """Return the sum of squares, PV units squared."""
        return float(self.errors(at[np.newaxis])[0])

    def errors(self, points: FloatArray) -> FloatArray:
        """Return the sums of squares at points of the unit cube, (m, k), PV units squared, (m,)."""
        parts = (points[i : i + AT_ONCE] for i in range(0, len(points), AT_ONCE))
        return np.concatenate([np.empty(0), *(errors_of(self.rows(each), self.target) for each in parts)])

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

    def rows(self, points: FloatArray) -> FloatArray:
        """Return the whitened columns as rows, (m, c, n); zero before the first prediction."""
        rows = Objective.rows(self, points)
        flat = rows.reshape(-1, rows.shape[-1])
        return self.noise.filtered(flat.T, before=0.0).T.reshape(rows.shape)


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
        """Return all coordinates, (..., k), of those that move."""
        point = np.empty((*free.shape[:-1], len(self.at)))
        point[...] = self.at
        point[..., self.free] = free
        return point

    def solved(self, free: FloatArray) -> Solved:
        """Return the best coefficients at a point, those that stay among them."""
        columns, target = self._posed(free)
        found = solve(columns, target)
        coefficients = self.coefficients.copy()
        coefficients[self.solved_for] = found.coefficients
        return replace(found, coefficients=coefficients)

    def residuals(self, free: FloatArray) -> FloatArray:
        """Return what the best coefficients leave at points, each a row, PV units, (m, n)."""
        if self.solved_for.all():
            return self.objective.residuals(self.whole(free))
        return np.array([self.solved(each).residual for each in free])

    def errors(self, free: FloatArray) -> FloatArray:
        """Return the sums of squares at points, PV units squared, (m,)."""
        if self.solved_for.all():
            return self.objective.errors(self.whole(free))
        posed = (self._posed(each) for each in free)
        return np.array([errors_of(columns.T[np.newaxis], target)[0] for columns, target in posed])

    def error(self, free: FloatArray) -> float:
        """Return the sum of squares, PV units squared."""
        return float(self.errors(free[np.newaxis])[0])

    def _posed(self, free: FloatArray) -> tuple[FloatArray, ProjectedPv]:
        """Return the columns that are solved for, and PV less the others."""
        columns, target = self.objective.columns(self.whole(free)), self.objective.target
        if self.solved_for.all():
            return columns, target
        known = (columns[:, ~self.solved_for] @ self.coefficients[~self.solved_for]) * target.weight
        known -= target.basis @ (target.basis.T @ known)
        sign = target.gain_sign if self.solved_for[0] else 0  # else no column is the response
        return columns[:, self.solved_for], replace(target, pv=target.pv - known, gain_sign=sign)


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
