"""Searching around the best model: many valves near it, with any stem, follow the record from its beginning.

A search often ends beside the right valve, with S and J off by some per cent because the stem is wrong: its
random steps begin where the whole record has its needle, and none leads out. Over few periods the basin is
wide enough to be hit by chance, and by shots it can be followed from there
(docs/decisions/0037-around-the-best.md).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from agent.analysis.quantify.free_run.search import Found, surer
from agent.analysis.quantify.free_run.shooting import Shots
from agent.analysis.quantify.free_run.shooting_search import Stage, shot
from agent.identify.fitted import Fitted
from agent.identify.objective import (
    DELAY,
    FIRST,
    J_RATIO,
    LEVEL,
    LOG_DAMPING,
    LOG_REST,
    STEM_HIGH,
    STEM_LOW,
    S,
)

if TYPE_CHECKING:
    import numpy as np

    from agent.analysis.record.recording import LoopHints
    from agent.identify.problem import Problem


class Spread(NamedTuple):
    """Standard deviations of scattered valves, OP spans."""

    s: float
    j: float


SPREADS = (Spread(0.01, 0.015), Spread(0.02, 0.03), Spread(0.04, 0.06))
SCATTERED = 40
LEAST_S = 0.002
"""OP spans, as in every random step."""
STAGES = (
    Stage(8, Shots(0.5, 4.0), 0.4, 100, 12),
    Stage(20, Shots(0.5, 4.0), 0.4, 80, 6),
    Stage(math.inf, Shots(0.5, 10.0), 0.3, 200, 3),
)


def searched_around(found: Found, problem: Problem, hints: LoopHints, rng: np.random.Generator) -> Found:
    """Return what is found around the best model, where it needs less by shots."""
    best = found.best
    near = [scattered(best, SPREADS[i % len(SPREADS)], problem, rng) for i in range(SCATTERED)]
    return surer(found, *shot([best, *near], best, STAGES, problem, rng), problem, hints, rng)


def scattered(fitted: Fitted, spread: Spread, problem: Problem, rng: np.random.Generator) -> Fitted:
    """Return a valve near one that was found, with any stem; its error is not known yet.

    S trades off with the delay, which goes along; the first slip stays about where it is.
    """
    candidate = fitted.candidate.copy()
    span = problem.op_span
    s = min(max(LEAST_S * span, candidate[S] + spread.s * span * rng.standard_normal()), span)
    j = candidate[S] * candidate[J_RATIO] + spread.j * span * rng.standard_normal()
    more = s - candidate[S]
    candidate[[S, J_RATIO]] = s, min(max(j / s, 0.0), 1.0)
    candidate[LEVEL] += 0.5 * candidate[FIRST] * more
    if problem.fixed_delay == 0:
        candidate[DELAY] = min(max(1.0, candidate[DELAY] - more / problem.op_speed), problem.max_delay)
    candidate[LOG_DAMPING : LOG_REST + 1] = rng.uniform(STEM_LOW, STEM_HIGH)
    return Fitted(math.inf, fitted.structure, candidate)
