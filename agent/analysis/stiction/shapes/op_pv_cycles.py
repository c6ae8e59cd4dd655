"""A few regular cycles of OP and PV, filtered to the band in which the loop is nonlinear.

Source: Choudhury, Shah, Thornhill and Shook, Control Engineering Practice 14 (2006) 1395; reconstructed
from reference ``methods.md`` 3.8, stage 2. Settled here: the filter is a Butterworth band-pass without
phase instead of a Wiener filter; its band always holds the oscillation; without a nonlinearity the
oscillation stands for the peak.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy import signal

from agent.analysis.record.signals import detrended, regularity
from agent.analysis.stiction.shapes.stretch import longest_stretch

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray, LoopWindow
    from agent.analysis.stiction.bicoherence import SquaredBicoherence

LOWEST, HIGHEST = 0.004, 0.5
"""Ends of the band, cycles a block of the bicoherence (published for samples)."""
BESIDE = 0.05
"""From the peak to each edge of the band, in the same unit (published)."""
CYCLES = 5
"""Cycles in the stretch; published are 3 to 5."""
LEAST_WIDTH = 0.01
"""Apparent stiction over the span of OP from which a valve sticks (published)."""


@dataclass(frozen=True, slots=True)
class Cycles:
    """Band-passed OP and PV of the most regular cycles; both arrays have shape (m,)."""

    op: FloatArray
    """OP units, about 0."""
    pv: FloatArray
    """PV units, about 0."""


def op_pv_cycles(window: LoopWindow, nonlinearity: SquaredBicoherence) -> Cycles | None:
    """Return the most regular cycles of ``window``; None where PV has too few, or OP stands still.

    Args:
        window: With a bicoherence, so at least five periods.
        nonlinearity: Of its control error.
    """
    stretch = longest_stretch(window)
    op, pv = (_band_passed(each, nonlinearity) for each in (stretch.op, stretch.pv))
    part = most_regular(pv)
    return None if part is None or not op.any() else Cycles(op[part], pv[part])


def most_regular(values: FloatArray) -> slice | None:
    """Return the ``CYCLES`` cycles of ``values`` (n,), from crossing to crossing, whose periods vary least.

    None where there are fewer.
    """
    below = np.signbit(values)
    crossings = np.flatnonzero(below[1:] != below[:-1]) + 1
    periods = crossings[2:] - crossings[:-2]  # each half a cycle after the one before
    if len(periods) < 2 * CYCLES - 1:
        return None
    stretches = np.lib.stride_tricks.sliding_window_view(periods, 2 * CYCLES - 1)
    best = int(np.argmax([regularity(each, 1.0) for each in stretches]))
    return slice(int(crossings[best]), int(crossings[best + 2 * CYCLES]))


def span_of(window: LoopWindow) -> float:
    """Return the span of the valve where it is known, else of OP in ``window``, OP units."""
    low, high = window.hints.op_range or (0.0, window.op_span)
    return high - low


def _band_passed(values: FloatArray, nonlinearity: SquaredBicoherence) -> FloatArray:
    """Return ``values`` (n,) in the band of the nonlinearity, same unit; zero where they stand still."""
    f = nonlinearity.frequency
    peak = (f, *nonlinearity.peak) if nonlinearity.nonlinear else (f,)
    low = max(LOWEST, min(peak) - BESIDE) / nonlinearity.block
    high = min(HIGHEST, max(peak) + BESIDE) / nonlinearity.block
    if high < HIGHEST:
        sections = signal.butter(2, (2 * low, 2 * high), btype="bandpass", output="sos")
    else:
        sections = signal.butter(2, 2 * low, btype="highpass", output="sos")
    padding = min(round(1 / low), len(values) - 1)  # the filter remembers so long
    rest = signal.sosfiltfilt(sections, detrended(values), padlen=padding)
    return np.asarray(rest * np.max(np.abs(values)), dtype=np.float64)
