"""From many rough points to the least free-run error: a scan, then local searches from the best.

The error has several basins, so that one start is not enough. From each, steps of Gauss and Newton; then a
simplex where the error itself has steps or kinks, at a slip, a stop or an event.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.stats.qmc import LatinHypercube

from agent.workbench.gauss_newton import lowest
from agent.workbench.library import instants
from agent.workbench.simplex import lowered_by_simplex

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from agent.analysis.record.recording import FloatArray
    from agent.workbench.objective import Objective, Pinned

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
    errors = objective.errors(starts).tolist()
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
    return lowered_by_simplex(objective.errors, found, step, evaluations, near=1.0, flat=flat)


def by_slopes(objective: Objective | Pinned, start: FloatArray) -> FloatArray:
    """Return the best point that steps of Gauss and Newton find from ``start`` (k,)."""
    if not len(start):
        return start
    if objective.model.base.linear:
        return lowest(objective.residuals, start, STEPS, COARSE)
    flat = SAME / objective.count  # its numbers may go on for long where the record says little of them
    return lowest(objective.residuals, start, BALANCE_STEPS, SMOOTH, flat)


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
