"""Many stems for a valve whose S and J may be right: the best of them in free run over few periods.

How soon a stem stops decides where each stroke begins, and that of the grid it comes from may be a hundred
times too quick to rest. A free run over a few periods costs little, so that each valve is tried with stems
from all over their range (docs/decisions/0039-few-periods-sample-by-sample.md).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.quantify.free_run.fitted import evaluated
from agent.identify.objective import (
    DELAY,
    LOG_DAMPING,
    LOG_REST,
    STEM_HIGH,
    STEM_LOW,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agent.analysis.record.recording import FloatArray
    from agent.identify.fitted import Fitted
    from agent.identify.problem import Problem

TRIED = 100
"""Stems for each valve."""


def with_best_stems(fits: Sequence[Fitted], problem: Problem, rng: np.random.Generator) -> list[Fitted]:
    """Return each valve with the best of many stems on this record, or as it is where none is better.

    With its error by free run, PV units squared.
    """
    return [_with_best_stem(each, problem, rng) for each in fits]


def _with_best_stem(fitted: Fitted, problem: Problem, rng: np.random.Generator) -> Fitted:
    begun = fitted.candidate
    tried = np.tile(begun, (TRIED + 1, 1))
    tried[1:, LOG_DAMPING : LOG_REST + 1] = rng.uniform(STEM_LOW, STEM_HIGH, (TRIED, 3))
    if problem.fixed_delay == 0:
        # What a stem takes longer is not for the process.
        tried[:, DELAY] = np.maximum(1.0, begun[DELAY] + _lag(begun) - _lag(tried))
    return min(evaluated(list(tried), fitted.structure, problem), key=lambda each: each.error)


def _lag(candidates: FloatArray) -> FloatArray:
    """Return the time constants of stem and supply together, samples, (...,)."""
    return np.asarray(np.exp(candidates[..., LOG_DAMPING : LOG_DAMPING + 2]).sum(-1))
