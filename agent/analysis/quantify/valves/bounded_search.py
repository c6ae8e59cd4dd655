"""Global search over the bounded space of stiction: Lee, Ren and Huang (2008), sections V.C and V.D.

The space is f_D >= 0, J >= 0, 2 f_D + J <= S0. The error has many local minima in it and is flat between
jumps, so derivatives are of no use.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray

Objective = Callable[["FloatArray"], "FloatArray"]
"""Errors (k,) of bands (k, 2): f_S and f_D, OP units. Infinite where no process fits."""

RESOLUTION = 0.01
"""Step of the grid, share of S0; the paper says 1 % to 2 %."""


def grid(largest: float, resolution: float = RESOLUTION) -> FloatArray:
    """Return the bands of the contour map, OP units, (2601, 2) at 1 %; the first is no stiction."""
    count = round(1 / resolution)
    f_s, f_d = np.meshgrid(np.arange(count + 1), np.arange(count + 1), indexing="ij")
    inside = (f_d <= f_s) & (f_s + f_d <= count)
    return np.stack([f_s[inside], f_d[inside]], axis=1) * np.float64(resolution * largest)


def grid_search(objective: Objective, largest: float) -> FloatArray:
    """Return the lowest point of the contour map; the paper's Table I prints such multiples of 1 %."""
    candidates = grid(largest)
    return np.asarray(candidates[np.argmin(objective(candidates))])


def random_search(objective: Objective, largest: float) -> FloatArray:
    """Multistart adaptive random search, then a local search from the best of its ends.

    Each start makes normal steps about its best point and halves them after some that fail. No stiction is
    one of the starts, lest the search should miss it. The seed is fixed: one record, one answer.
    """
    starts, failures_allowed, kept = 32, 6, 4
    random = np.random.default_rng(2008)
    best = within(largest * random.random((starts, 2)), largest)
    best[0] = 0.0
    errors = objective(bands(best))
    scale = np.full(starts, largest / 4)
    failures = np.zeros(starts, dtype=int)
    while scale.max() > RESOLUTION * largest:
        trial = within(best + scale[:, None] * random.standard_normal((starts, 2)), largest)
        trial_errors = objective(bands(trial))
        better = trial_errors < errors
        best[better], errors[better] = trial[better], trial_errors[better]
        failures = np.where(better, 0, failures + 1)
        stale = failures >= failures_allowed
        scale[stale] /= 2
        failures[stale] = 0
    most_promising = np.argsort(errors, kind="stable")[:kept]
    step = RESOLUTION * largest
    ends = [pattern_search(objective, best[start], largest, step) for start in most_promising]
    point, _ = min(ends, key=lambda end: end[1])
    found: FloatArray = bands(point[None])[0]
    return found


def pattern_search(
    objective: Objective, point: FloatArray, largest: float, step: float
) -> tuple[FloatArray, float]:
    """Go from a point (S, J) to its best neighbour, halving the step where none is better.

    Args:
        objective: What to make small.
        point: Start, OP units, (2,).
        largest: S0, OP units.
        step: First distance of the neighbours, OP units; the last is a sixteenth of RESOLUTION.

    Returns:
        The point (S, J) where no neighbour is better, OP units, and its error.
    """
    ways = np.array([(s, j) for s in (-1, 0, 1) for j in (-1, 0, 1) if s or j])
    error = float(objective(bands(point[None]))[0])
    while step > RESOLUTION * largest / 16:
        neighbours = within(point + step * ways, largest)
        errors = objective(bands(neighbours))
        if errors.min() < error:
            point, error = neighbours[np.argmin(errors)], float(errors.min())
        else:
            step /= 2
    return point, error


def within(s_j: FloatArray, largest: float) -> FloatArray:
    """Return the points (k, 2) put back onto 0 <= J <= S <= S0. The bounds matter: often f_D is zero."""
    s = np.clip(s_j[:, 0], 0.0, largest)
    return np.stack([s, np.clip(s_j[:, 1], 0.0, s)], axis=1)


def bands(s_j: FloatArray) -> FloatArray:
    """Return f_S and f_D, shape (k, 2), of points (S, J), shape (k, 2); OP units."""
    s, j = s_j[:, 0], s_j[:, 1]
    return np.stack([(s + j) / 2, (s - j) / 2], axis=1)
