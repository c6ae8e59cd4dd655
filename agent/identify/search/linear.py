"""The best model whose valve follows OP."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from agent.identify.objective import DELAY, LOG_TAU, LOG_TAU2, SIZE, STEM_LOW, LOG_DAMPING, LOG_REST
from agent.identify.fitted import Fitted, best_of
from agent.identify.search.population import Population, refit

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agent.identify.arrays import FloatArray
    from agent.identify.problem import Problem

TAUS, DELAYS = 8, 6
"""Starts in the time constant and in the delay."""
PASSES = 25
"""Gauss-Newton steps of a start, at most."""
SECOND = -1.6
"""Log of the second time constant over the first, where a start has one."""


def best_linear(problem: Problem, structures: Sequence[int], also: Fitted | None = None) -> Fitted | None:
    """Return the best process behind a valve that follows OP; None where none of the possible follows it.

    ``also`` lends its process as one more start.
    """
    starts = process_grid(problem, SECOND)
    if also is not None:
        lent = starts[0].copy()
        lent[[LOG_TAU, DELAY, LOG_TAU2]] = also.candidate[[LOG_TAU, DELAY, LOG_TAU2]]
        starts = np.vstack([starts, lent])
    candidates = np.concatenate([starts] * len(structures))
    of = np.repeat(np.array(structures, dtype=np.int64), len(starts))
    population = Population(candidates, of, np.full(len(of), math.inf))
    refit(population, problem, PASSES)
    best = best_of(population, problem)
    return best if math.isfinite(best.error) else None


def process_grid(problem: Problem, second: float) -> FloatArray:
    """Return candidates without stiction over time constants and delays, (k, SIZE).

    ``second`` is the log of the second time constant over the first.
    """
    delays = [problem.fixed_delay] if problem.fixed_delay > 0 else np.linspace(1, 0.75 * problem.max_delay, DELAYS)
    grid = []
    for log_tau in np.linspace(math.log(0.7), problem.max_log_tau - 1, TAUS):
        for delay in delays:
            candidate = np.zeros(SIZE)
            candidate[[LOG_TAU, DELAY, LOG_TAU2]] = log_tau, delay, log_tau + second
            candidate[LOG_DAMPING : LOG_REST + 1] = STEM_LOW
            grid.append(candidate)
    return np.array(grid)
