"""The nearest candidate that a valve and a process may have."""

from __future__ import annotations

from agent.identify.arrays import FloatArray
from agent.identify.objective import (
    BRISTLES,
    DELAY,
    J_RATIO,
    LEAST_LOG_TAU,
    LOG_DAMPING,
    LOG_TAU,
    LOG_TAU2,
    STEM_HIGH,
    STEM_LOW,
    S,
)
from agent.identify.problem import Problem
from agent.jit import kernel
from agent.physics.valves.damped_stem import GIVE


@kernel
def keep_in_bounds(candidate: FloatArray, problem: Problem) -> None:
    """Move each coordinate of a candidate that sticks to the nearest value that it may have, in place."""
    span = problem.op_span
    candidate[S] = min(max(candidate[S], 0.0), span)
    candidate[J_RATIO] = min(max(candidate[J_RATIO], 0.0), 1.0)
    for axis in range(3):
        place = LOG_DAMPING + axis
        candidate[place] = min(max(candidate[place], STEM_LOW[axis]), STEM_HIGH[axis])
    if candidate[BRISTLES] < GIVE[0]:
        candidate[BRISTLES] = 0.0
    candidate[BRISTLES] = min(candidate[BRISTLES], GIVE[1])
    candidate[LOG_TAU] = min(max(candidate[LOG_TAU], LEAST_LOG_TAU), problem.max_log_tau)
    candidate[LOG_TAU2] = min(max(candidate[LOG_TAU2], LEAST_LOG_TAU), candidate[LOG_TAU])
    candidate[DELAY] = min(max(candidate[DELAY], 1.0), problem.max_delay)
    if problem.fixed_delay > 0.0:
        candidate[DELAY] = problem.fixed_delay
