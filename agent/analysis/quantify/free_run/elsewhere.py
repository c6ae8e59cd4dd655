"""From a model to the best that differs from it in one value of the valve, anywhere in that value's range.

Of a neighbouring valley often one value is wrong, and by far: J, or how soon the stem rests. Random steps
around a model do not reach there; forty places of each value take as long as one refinement
(docs/decisions/0039-few-periods-sample-by-sample.md).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.quantify.free_run.fitted import evaluated, refine
from agent.identify.fitted import Fitted, by_error
from agent.identify.objective import (
    DELAY,
    FIRST,
    J_RATIO,
    LEVEL,
    LOG_DAMPING,
    LOG_REST,
    LOG_SUPPLY,
    RIGID,
    STEM_HIGH,
    STEM_LOW,
    S,
)

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray
    from agent.identify.problem import Problem

PLACES = 40
"""Of each value."""
TURNS = 4
"""At most."""
GAINS = 0.98
"""Error over that before, below which another turn follows."""


def moved_elsewhere(fitted: Fitted, problem: Problem, rng: np.random.Generator) -> Fitted:
    """Return what is found by moving one value at a time, as long as that gains."""
    for _ in range(TURNS):
        tried = [best_of(each, fitted, problem) for each in one_by_one(fitted.candidate, problem)]
        (found, *_) = by_error([*refine(tried, problem, 0.15, (30, 80), rng), fitted])
        before, fitted = fitted, found
        if fitted.error > GAINS * before.error:
            break
    return fitted


def best_of(candidates: FloatArray, fitted: Fitted, problem: Problem) -> Fitted:
    """Return the best of some candidates with the structure of ``fitted``."""
    return min(evaluated(list(candidates), fitted.structure, problem), key=lambda each: each.error)


def one_by_one(begun: FloatArray, problem: Problem) -> list[FloatArray]:
    """Return candidates that differ from one in a value each, (PLACES, SIZE) for each value."""
    s, j = begun[S], begun[S] * begun[J_RATIO]
    span = problem.op_span
    s_values = np.linspace(1 / PLACES, 1.0, PLACES) * span
    found = []
    for keeps_ratio in (False, True):
        moved = np.tile(begun, (PLACES, 1))
        moved[:, S] = s_values
        moved[:, J_RATIO] = begun[J_RATIO] if keeps_ratio else np.minimum(j / s_values, 1.0)
        moved[:, LEVEL] += 0.5 * begun[FIRST] * (s_values - s)
        if problem.fixed_delay == 0:
            moved[:, DELAY] = np.clip(
                begun[DELAY] - (s_values - s) / problem.op_speed, 1.0, problem.max_delay
            )
        found.append(moved)
    found.append(at_places(begun, J_RATIO, np.linspace(0.0, 1.0, PLACES)))
    found.append(at_places(begun, LEVEL, begun[LEVEL] + np.linspace(-0.5, 0.5, PLACES) * s))
    if begun[LOG_REST] > RIGID:
        for axis in (LOG_DAMPING, LOG_SUPPLY, LOG_REST):
            low, high = STEM_LOW[axis - LOG_DAMPING], STEM_HIGH[axis - LOG_DAMPING]
            moved = at_places(begun, axis, np.linspace(low, high, PLACES))
            if axis != LOG_REST and problem.fixed_delay == 0:
                # What a stem takes longer is not for the process.
                later = np.exp(moved[:, axis]) - math.exp(begun[axis])
                moved[:, DELAY] = np.maximum(1.0, begun[DELAY] - later)
            found.append(moved)
    return found


def at_places(begun: FloatArray, axis: int, places: FloatArray) -> FloatArray:
    """Return candidates with one coordinate at each of the places."""
    moved = np.tile(begun, (len(places), 1))
    moved[:, axis] = places
    return moved
