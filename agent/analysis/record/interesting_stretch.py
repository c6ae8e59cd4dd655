"""The stretch of a long record that shows most: a day of a loop drawn whole is a solid block."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.record.reversals import reversal_places

if TYPE_CHECKING:
    from agent.analysis.record.recording import LoopWindow

WHOLE = 4000
"""Samples up to which a record is shown whole: at 12 inches a stroke still has a width."""
PERIODS = 15.0
"""Of the oscillation, in the stretch that is shown."""
LEAST = 600
"""Samples of the shortest stretch."""


def interesting_stretch(window: LoopWindow, period: float | None = None) -> slice:
    """Return which samples of a record to show: those with most reversals of OP, in known samples.

    Args:
        window: The record.
        period: Of its oscillation, s; None where it has none.
    """
    n = len(window)
    if n <= WHOLE:
        return slice(0, n)
    wanted = WHOLE if period is None else PERIODS * period / window.ts
    length = int(min(max(wanted, LEAST), WHOLE))
    marks = np.zeros(n)
    marks[reversal_places(window.op)] = 1.0
    shown = np.convolve(marks * window.valid, np.ones(length), mode="valid")
    known = np.convolve(window.valid.astype(np.float64), np.ones(length), mode="valid") / length
    best = np.flatnonzero(shown * known >= 0.999 * (shown * known).max())
    start = int(best[len(best) // 2])
    return slice(start, start + length)
