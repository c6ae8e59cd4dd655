"""The best process behind a valve that follows OP, or behind a known one."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from agent.identify.fitted import Fitted, start
from agent.identify.objective import DELAY, LOG_TAU, LOG_TAU2, SIZE, SOPDT
from agent.identify.search.population import Candidates, counted_blocks, refit
from agent.identify.search.price import price
from agent.identify.simplex import polished

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agent.identify.arrays import FloatArray
    from agent.identify.problem import Problem

FIRST_PASSES, GO_ON = 4, 8
"""Gauss-Newton steps of every start, and how many starts, the best after these, go on."""
PASSES = 25
"""Gauss-Newton steps of those, at most."""
SECONDS = (-1.6, -0.2)
"""Logs of the second time constant over the first, where a start has one: a step that makes a small one
vanish does not come back, for no derivative shows it."""


def best_linear(problem: Problem, structures: Sequence[int], also: Fitted | None = None) -> Fitted | None:
    """Return the best process behind a valve that follows OP; None where none of the possible follows it.

    ``also`` lends its process as one more start.
    """
    ends = []
    for structure in structures:
        starts = _starts(problem, structure, also)
        count = len(starts)
        population = Candidates(starts, np.full(count, structure), np.full(count, math.inf))
        refit(population, problem, FIRST_PASSES)
        population = population.sorted(GO_ON)
        refit(population, problem, PASSES)
        end = start(population.sorted(1).candidates[0], structure, problem)
        ends += [polished(end, problem)] if math.isfinite(end.error) else []
    return by_price(ends, problem)


def _starts(problem: Problem, structure: int, also: Fitted | None) -> FloatArray:
    """Return where the fits of a structure begin, (k, SIZE)."""
    seconds = SECONDS if structure == SOPDT else SECONDS[:1]
    starts = np.array([each for second in seconds for each in process_grid(problem, second)])
    if also is None:
        return starts
    lent = starts[0].copy()
    lent[[LOG_TAU, DELAY, LOG_TAU2]] = also.candidate[[LOG_TAU, DELAY, LOG_TAU2]]
    return np.vstack([starts, lent])


def by_price(fits: Sequence[Fitted], problem: Problem) -> Fitted | None:
    """Return the one that costs least, its error times its price; None of none."""
    count = counted_blocks(problem)
    costs = [each.error * price(each.candidate, each.structure, problem, count) for each in fits]
    return fits[int(np.argmin(costs))] if fits else None


def process_behind(fitted: Fitted, problem: Problem) -> Fitted:
    """Return a candidate with its process fitted to another view of its record; the valve stays."""
    one = Candidates(fitted.candidate[None].copy(), np.array([fitted.structure]), np.array([math.inf]))
    refit(one, problem, PASSES)
    return start(one.candidates[0], fitted.structure, problem)


def process_grid(problem: Problem, second: float) -> list[FloatArray]:
    """Return candidates without stiction over time constants and delays, (SIZE,) each.

    ``second`` is the log of the second time constant over the first.
    """
    delays = [problem.fixed_delay] if problem.fixed_delay > 0 else np.linspace(1, 0.75 * problem.max_delay, 6)
    grid = []
    for log_tau in np.linspace(math.log(0.7), problem.max_log_tau - 1, 8):
        for delay in delays:
            candidate = np.zeros(SIZE)
            candidate[[LOG_TAU, DELAY, LOG_TAU2]] = log_tau, delay, log_tau + second
            grid.append(candidate)
    return grid
