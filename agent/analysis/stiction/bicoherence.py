"""Bicoherence of the control error: do its frequencies couple in threes, as only a nonlinearity makes them?

Sources: M. A. A. S. Choudhury, S. L. Shah and N. F. Thornhill, "Diagnosis of poor control-loop performance
using higher-order statistics", Automatica 40 (2004) 1719; the same with D. S. Shook, "Automatic detection
and quantification of stiction in control valves", Control Engineering Practice 14 (2006) 1395.
Reconstructed from reference ``methods.md`` 3.8, where the critical mean is derived.

The papers find nonlinearity; that it sits in the valve they conclude from the ellipse of OP and PV
(``choudhury_ellipse``, ``choudhury_cmeans``). So this detector never names stiction. Settled here: block
means bring two cycles and a half into a segment; the hop between segments is no simple part of the period,
for else all segments of a steady wave begin alike and any wave looks coupled; a limit of NGI for short
records; a loop is called linear only where its third harmonic is known to be absent.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy import fft, signal

from agent.analysis.record.signals import ROUND_OFF, detrended
from agent.analysis.results import MethodKind, MethodResult, MethodVerdict, Oscillation
from agent.analysis.stiction.shapes.stretch import longest_stretch, period_of
from agent.analysis.stiction.shapes.third_harmonic import ThirdHarmonic, third_harmonic
from agent.physics.processes.decimation import block_means

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray, LoopWindow

SEGMENT, LINES = 64, 128
"""Samples in a segment, and of its zero-padded transform (published)."""
HOPS = np.arange(24, 41)
"""Samples from segment to segment; published is 32."""
MOST_SAMPLES = 25.0
"""Samples a period; slower waves are averaged in blocks, so that a segment has two and a half periods."""
FEWEST_SAMPLES = 7.0
"""Samples a period; with fewer the third harmonic is near the Nyquist frequency."""
FEWEST_PERIODS = 5.0
FEWEST_SEGMENTS = 10
"""For any answer."""
ENOUGH_SEGMENTS = 30
"""To call a loop linear (``methods.md`` 8.4)."""
NOT_GAUSSIAN = 0.001
"""NGI from which a signal is not Gaussian (published, for 4096 samples, K = 127)."""
SCATTER = 0.25
"""NGI times K that linear Gaussian signals exceed in 1 of 200 records, for K from 8 to 128 (simulated white
noise and AR(2) oscillations of periods 10 to 25). It rules below K = 250, where the published limit is within
the scatter."""
NONLINEAR = 0.01
"""NLI from which a signal is nonlinear (published)."""
F1, F2 = (
    f.astype(np.intp)
    for f in np.array([(i, j) for i in range(1, LINES // 2) for j in range(1, i + 1) if 2 * i + j <= LINES]).T
)
"""Lines of the principal domain f2 <= f1, 2 f1 + f2 <= 1, each (L,)."""
CRITICAL = (1.96 + np.sqrt(4 * len(F1) - 1)) ** 2 / (4 * len(F1))
"""K times the mean of the squared bicoherence that chance exceeds in 1 of 40 records, were its values
independent: 2 K bic^2 has a chi-square distribution with 2 degrees of freedom."""


@dataclass(frozen=True, slots=True)
class SquaredBicoherence:
    """What the detector measured; L pairs of frequencies."""

    squared: FloatArray
    """0 to 1, (L,), at ``F1`` and ``F2``."""
    segments: int
    """K"""
    block: int
    """Samples in a block; frequencies are per block."""
    frequency: float
    """Of the oscillation, cycles a block."""
    harmonic: ThirdHarmonic

    @property
    def ngi(self) -> float:
        """Non-Gaussianity index: mean less its critical value."""
        return float(np.mean(self.squared) - CRITICAL / self.segments)

    @property
    def nli(self) -> float:
        """Nonlinearity index: how far the largest value is from what a flat bicoherence scatters to."""
        return abs(float(np.max(self.squared) - np.mean(self.squared) - 2 * np.std(self.squared)))

    @property
    def nonlinear(self) -> bool:
        """Whether both indices are beyond their limits."""
        return self.ngi > max(NOT_GAUSSIAN, SCATTER / self.segments) and self.nli > NONLINEAR

    @property
    def peak(self) -> tuple[float, float]:
        """Frequencies of the highest value, the lower one first, cycles a block."""
        highest = int(np.argmax(self.squared))
        return float(F2[highest]) / LINES, float(F1[highest]) / LINES

    def judge(self) -> tuple[MethodVerdict, str]:
        """Return the verdict that follows without OP, and its reason."""
        found = f"NGI {self.ngi:.3f}, NLI {self.nli:.3f} over {self.segments} segments"
        if self.nonlinear:
            return "undecided", f"the loop is not linear, the cause is not known: {found}"
        if self.segments < ENOUGH_SEGMENTS:
            return (
                "undecided",
                f"too few segments to call it linear, {ENOUGH_SEGMENTS} are needed: {found}",
            )
        if self.harmonic == "seen":
            return "undecided", f"the wave has a third harmonic, which the bicoherence cannot detect: {found}"
        if self.harmonic == "hidden":
            return "undecided", f"no coupling is found, but noise would hide a third harmonic: {found}"
        return "no_stiction", f"the loop is linear: {found}"


@dataclass(frozen=True, slots=True)
class Bicoherence:
    """For all loops that oscillate long enough; the index is NGI."""

    name: str = "bicoherence"
    kind: MethodKind = "limit_cycle"

    def detect(self, window: LoopWindow, oscillation: Oscillation) -> MethodResult:
        """Call the loop linear, or undecided: the cause of a nonlinearity stays open."""
        seen = error_bicoherence(window, oscillation)
        if isinstance(seen, str):
            return MethodResult("not_applicable", None, seen)
        verdict, reason = seen.judge()
        return MethodResult(verdict, seen.ngi, reason, seen)


def error_bicoherence(window: LoopWindow, oscillation: Oscillation) -> SquaredBicoherence | str:
    """Return the bicoherence of the control error, or the limit that is broken as a text."""
    stretch = longest_stretch(window)
    period = period_of(stretch, oscillation, periods=FEWEST_PERIODS, samples=FEWEST_SAMPLES)
    if isinstance(period, str):
        return period
    error = detrended(stretch.error)
    block = int(np.ceil(period / MOST_SAMPLES))
    values, frequency = block_means(error, block), block / period
    hop = best_hop(frequency)
    segments = (len(values) - SEGMENT) // hop + 1
    if segments < FEWEST_SEGMENTS:
        return f"only {max(segments, 0)} segments of 2.5 periods or more, {FEWEST_SEGMENTS} are needed"
    if not error.any():
        return "the control error does not move"
    squared = squared_bicoherence(values, hop)
    return SquaredBicoherence(squared, segments, block, frequency, third_harmonic(error, period))


def best_hop(frequency: float) -> int:
    """Return the hop after which neither the wave nor its first harmonics begin alike.

    Args:
        frequency: Of the wave, cycles a sample.
    """
    turns = np.outer((1, 2, 3), HOPS * frequency)
    return int(HOPS[np.argmax(np.min(np.abs(turns - np.round(turns)), axis=0))])


def squared_bicoherence(values: FloatArray, hop: int) -> FloatArray:
    """Return the squared bicoherence at ``F1`` and ``F2``, (L,), 0 to 1.

    Args:
        values: Signal without gaps, (n,), n >= 64.
        hop: Samples from segment to segment.
    """
    segments = np.lib.stride_tricks.sliding_window_view(values, SEGMENT)[::hop]
    tapered = signal.detrend(segments, type="constant") * signal.windows.hann(SEGMENT)
    x = fft.fft(tapered, LINES)
    x[np.abs(x) < ROUND_OFF * np.max(np.abs(x))] = 0.0  # else the bicoherence would couple round-off noise
    pairs, sums = x[:, F1] * x[:, F2], x[:, F1 + F2]
    powers = np.mean(np.abs(pairs) ** 2, axis=0) * np.mean(np.abs(sums) ** 2, axis=0)
    coupled = np.abs(np.mean(pairs * sums.conj(), axis=0)) ** 2
    squared = np.zeros(len(F1))
    np.divide(coupled, powers, out=squared, where=powers > 0)
    return squared
