"""The part of a window that the shape detectors use, cut into half cycles.

Source: reference ``methods.md`` section 3, common preparation.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from scipy import signal

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray, LoopWindow
    from agent.analysis.results import Oscillation

CUT_OFF = 10.0
"""Cut-off of the low-pass in frequencies of the oscillation: it keeps the harmonics that make the shape."""
HALF_CYCLE = (0.25, 1.0)
"""Shortest and longest half cycle that counts, periods."""


@dataclass(frozen=True, slots=True)
class Stretch:
    """The longest part of a window without a gap; all arrays have shape (n,)."""

    op: FloatArray
    """OP units."""
    pv: FloatArray
    """PV units."""
    error: FloatArray
    """SP - PV, PV units."""
    mv: FloatArray | None
    """Measured valve position or flow, its own unit."""
    start: int
    """Its first sample in the window."""
    ts: float
    """s."""

    def __len__(self) -> int:
        return len(self.op)


def longest_stretch(window: LoopWindow) -> Stretch:
    """Return the longest part of ``window`` in which OP, PV, SP and MV (where recorded) are all finite."""
    whole = window.valid & np.isfinite(window.error)
    if window.mv is not None:
        whole &= np.isfinite(window.mv)
    edges = np.flatnonzero(np.diff(np.concatenate(([False], whole, [False]))))
    starts, ends = edges[::2], edges[1::2]
    start, end = 0, 0
    if starts.size:
        longest = int(np.argmax(ends - starts))
        start, end = int(starts[longest]), int(ends[longest])
    part = slice(start, end)
    mv = None if window.mv is None else window.mv[part]
    return Stretch(window.op[part], window.pv[part], window.error[part], mv, start, window.ts)


def period_of(stretch: Stretch, oscillation: Oscillation, *, periods: float, samples: float) -> float | str:
    """Return the period in samples, or the reason why the stretch cannot show a shape.

    Args:
        stretch: The part that is used.
        oscillation: Its oscillation.
        periods: The fewest periods without a gap that the method needs.
        samples: The fewest samples a period that it needs.
    """
    if oscillation.period is None:
        return "the period of the oscillation is not known"
    period = oscillation.period / stretch.ts
    if len(stretch) < periods * period:
        return f"fewer than {periods:.0f} periods without a gap"
    return period if period >= samples else f"fewer than {samples:.0f} samples a period"


def smoothed(values: FloatArray, period: float, cut_off: float = CUT_OFF) -> FloatArray:
    """Return ``values`` (n,) through a low-pass without phase, which leaves the shape of the oscillation.

    Args:
        values: Signal without gaps, at least three periods of it.
        period: Of the oscillation, samples; below 2.5 ``cut_off`` there is nothing to take out and a copy
            comes back.
        cut_off: Cut-off frequency over that of the oscillation.
    """
    corner = cut_off / period
    if corner >= 0.4:  # so near the Nyquist frequency a filter would do more harm than noise
        return values.copy()
    sections = signal.butter(2, 2 * corner, output="sos")
    return np.asarray(signal.sosfiltfilt(sections, values), dtype=np.float64)


def half_cycles(values: FloatArray, period: float) -> list[slice]:
    """Return the stretches between successive zero crossings of ``values`` (n,) that last 0.25 to 1 period.

    Each starts with its first sample on one side of zero and ends before the first on the other side.
    Take the mean or trend out, and smooth, before.
    """
    below = np.signbit(values)
    crossings = np.flatnonzero(below[1:] != below[:-1]) + 1
    shortest, longest = (part * period for part in HALF_CYCLE)
    return [
        slice(int(first), int(last))
        for first, last in pairwise(crossings)
        if shortest <= last - first <= longest
    ]
