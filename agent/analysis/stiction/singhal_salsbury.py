"""Where the error has its peaks: late in the half cycle when the valve sticks, else in its middle.

Source: A. Singhal and T. I. Salsbury, "A simple method for detecting valve stiction in oscillating control
loops", Journal of Process Control 15 (2005) 371; reference ``methods.md`` 3.3, which adds the t-test.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy import signal, special

from agent.analysis.results import MethodKind, MethodResult, Oscillation
from agent.analysis.stiction.shapes.stretch import half_cycles, longest_stretch, period_of, smoothed

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray, LoopWindow

FEWEST_HALF_CYCLES = 10
FEWEST_SAMPLES = 20.0
"""Samples a period; with fewer a peak is not known to a tenth of the half cycle."""
LATE = 1.1
"""Ratio from which the peaks are late: the published 1 with a margin, which the paper leaves open."""
ONE_SIDED_95 = 0.95


@dataclass(frozen=True, slots=True)
class PeakAreas:
    """What the detector measured."""

    error: FloatArray
    """Smoothed control error about its line, PV units, (n,)."""
    half_cycles: tuple[slice, ...]
    """The m half cycles of ``error`` that count."""
    peaks: tuple[int, ...]
    """The sample of the peak of each, in ``error``."""
    ratios: FloatArray
    """Area before the peak over the area after it, (m,)."""
    mean: float
    """Geometric mean of the ratios."""
    low: float
    """It lies above this with 95 % confidence (t-test on the logarithms)."""
    high: float
    """It lies below this with 95 % confidence."""


@dataclass(frozen=True, slots=True)
class SinghalSalsbury:
    """For self-regulating loops: behind a valve that jumps PV nears its end value, then turns at once."""

    name: str = "singhal_salsbury"
    kind: MethodKind = "limit_cycle"

    def detect(self, window: LoopWindow, oscillation: Oscillation) -> MethodResult:
        """Judge the ratio of the areas before and after the peaks, which is the index."""
        if window.hints.integrating:
            reason = "the peaks of an integrating loop do not depend on its valve"
            return MethodResult("not_applicable", None, reason)
        stretch = longest_stretch(window)
        period = period_of(stretch, oscillation, periods=FEWEST_HALF_CYCLES / 2, samples=FEWEST_SAMPLES)
        if isinstance(period, str):
            return MethodResult("not_applicable", None, period)
        seen = peak_areas(stretch.error, period)
        if seen is None:
            reason = f"fewer than {FEWEST_HALF_CYCLES} half cycles are about half a period long"
            return MethodResult("undecided", None, reason)
        return _judge(seen)


def _judge(seen: PeakAreas) -> MethodResult:
    found = f"the area before the peaks of the error is {seen.mean:.2f} of that after them"
    if seen.mean > LATE and seen.low > 1:
        return MethodResult("stiction", seen.mean, f"late peaks: {found}", seen)
    if seen.high < LATE:
        return MethodResult("no_stiction", seen.mean, f"no late peaks: {found}", seen)
    return MethodResult("undecided", seen.mean, f"the peaks scatter too much: {found}", seen)


def peak_areas(error: FloatArray, period: float) -> PeakAreas | None:
    """Compare the areas to both sides of the peaks of ``error`` (n,); ``period`` in samples.

    None where fewer than ten half cycles last between a quarter and a whole period.
    """
    smooth = smoothed(signal.detrend(error), period)
    cycles = half_cycles(smooth, period)
    if len(cycles) < FEWEST_HALF_CYCLES:
        return None
    height = np.abs(smooth)
    peaks = [each.start + int(np.argmax(height[each])) for each in cycles]
    # The peak's own sample counts half to each side, so that a symmetric half cycle gives 1.
    before = [
        height[each.start : peak].sum() + height[peak] / 2 for each, peak in zip(cycles, peaks, strict=True)
    ]
    after = [
        height[peak + 1 : each.stop].sum() + height[peak] / 2
        for each, peak in zip(cycles, peaks, strict=True)
    ]
    logarithms = np.log(np.array(before) / np.array(after))
    mean, deviation = float(np.mean(logarithms)), float(np.std(logarithms, ddof=1))
    margin = float(special.stdtrit(len(cycles) - 1, ONE_SIDED_95)) * deviation / np.sqrt(len(cycles))
    return PeakAreas(
        error=smooth,
        half_cycles=tuple(cycles),
        peaks=tuple(peaks),
        ratios=np.exp(logarithms),
        mean=float(np.exp(mean)),
        low=float(np.exp(mean - margin)),
        high=float(np.exp(mean + margin)),
    )
