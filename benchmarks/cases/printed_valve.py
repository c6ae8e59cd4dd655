"""How well the valves that the paper prints explain the records of its Table I, by the error of `free_run`.

S and J stay as printed; all else of valve and process is searched, so that a larger error is the valve's.
"""

from __future__ import annotations

from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.quantify.free_run.found import find
from agent.analysis.quantify.free_run.problem import pose
from agent.identify.fitted import Fitted, by_error, start
from agent.identify.objective import (
    DELAY,
    FIRST,
    J_RATIO,
    LEVEL,
    LOG_DAMPING,
    LOG_TAU,
    LOG_TAU2,
    SIZE,
    SOPDT,
    S,
)
from agent.identify.search.grid import STEMS
from agent.identify.search.linear import process_behind

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray, LoopWindow
    from agent.identify.problem import Problem
    from agent.units import FrictionBands

LEVELS, DELAYS, TAUS = 41, (2.0, 4.0, 8.0, 12.0, 16.0, 20.0, 30.0), (5.0, 15.0, 40.0)
"""Of the grid; delays and time constants in samples."""
KEPT, STEPS = 20, 3000
"""Cells whose process is fitted, and random steps of the stem and its first slip."""


def times_the_least(window: LoopWindow, printed: FrictionBands) -> float:
    """Return the squared error with a printed valve over the least that the search finds; NaN without one."""
    problem = pose(window)
    found = None if isinstance(problem, str) else find(window, problem)
    if isinstance(problem, str) or found is None:
        return np.nan
    return with_valve(problem, printed.s, printed.j / printed.s).error / found.least_error


def with_valve(problem: Problem, s: float, j_ratio: float) -> Fitted:
    """Return the best model whose valve has these S (OP units) and J/S."""
    cells = by_error([start(each, SOPDT, problem) for each in _grid(problem, s, j_ratio)])[:KEPT]
    best = by_error([process_behind(each, problem) for each in cells])[0]
    rng = np.random.default_rng(0)
    for step in range(STEPS):
        moved = best.candidate.copy()
        if step % 2:
            moved[LEVEL] += 0.02 * problem.op_span * rng.standard_normal()
        if step % 3:
            moved[LOG_DAMPING : LOG_DAMPING + 3] += 0.2 * rng.standard_normal(3)
        tried = start(moved, SOPDT, problem)
        if step % 20 == 0:
            tried = process_behind(tried, problem)
        best = min(best, tried, key=lambda each: each.error)
    return process_behind(best, problem)


def _grid(problem: Problem, s: float, j_ratio: float) -> list[FloatArray]:
    levels = np.linspace(problem.op.min(), problem.op.max(), LEVELS).tolist()
    candidates = []
    for level, first, stem, delay, tau in product(levels, (1.0, -1.0), STEMS, DELAYS, TAUS):
        candidate = np.zeros(SIZE)
        candidate[[LOG_TAU, LOG_TAU2]] = np.log(tau), np.log(tau) - 1
        candidate[[DELAY, S, J_RATIO, LEVEL, FIRST]] = delay, s, j_ratio, level, first
        candidate[LOG_DAMPING : LOG_DAMPING + 3] = np.log(stem)
        candidates.append(candidate)
    return candidates
