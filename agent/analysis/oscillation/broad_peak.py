"""A broad peak of the spectrum: an oscillation whose period wanders.

Such an oscillation has no line, and its autocorrelation decays soon; but its power still exceeds, an octave
wide, that of the slower and the faster octave. Noise of any colour and drift fall with the frequency. The
idea is that of every spectral test; the test itself is ours, and its limits are from simulation.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.oscillation.acf_zero_crossings import MIN_SAMPLES_PER_PERIOD
from agent.analysis.oscillation.spectrum import bridged, spectrum
from agent.analysis.record.recording import LoopWindow
from agent.analysis.record.signals import detrended
from agent.analysis.results import Oscillation

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray

CORE = (2**-0.5, 2**0.5)
"""The peak, in parts of its frequency: an octave."""
BELOW, ABOVE = (2**-1.5, 2**-0.5), (2**0.5, 2**1.5)
"""Its surroundings: the octaves to both sides."""
FEWEST_PERIODS = 6
"""With fewer the octave below holds less than two lines."""
CENTRES = 60
"""Frequencies that are tried, each the same factor above the one before."""
LEAST_SHARE = 0.25
"""Part of the power that the peak must hold."""
BEND = 2.0
"""Density over that of the surroundings which a bend of the spectrum makes: 1.5 where noise passes two equal
lags, and as much in the error of a loop that is tuned well."""
CHANCE = 3.0
"""Standard deviations by which it must exceed that: at most one in a hundred of 2800 simulated records of
noise of any colour does."""


@dataclass(frozen=True, slots=True)
class BroadPeak:
    """Answers with the clearer peak of control error and OP; it gives no regularity."""

    name: str = "broad_peak"
    noise_proof: bool = True

    def detect(self, window: LoopWindow) -> Oscillation:
        """Judge a window of at least six periods."""
        peaks = [clearest_peak(signal) for signal in (window.error, window.op)]
        known = [peak for peak in peaks if peak is not None]
        if not known:
            return Oscillation(detected=False, period=None, regularity=None)
        clear, period, share = max(known)
        return Oscillation(clear > CHANCE, period * window.ts, None, share)


def clearest_peak(signal: FloatArray) -> tuple[float, float, float] | None:
    """Return how far a peak stands out (standard deviations), its period (samples) and its share of power.

    None without a peak that holds enough of the power.
    """
    values = bridged(detrended(signal))
    if values is None:
        return None
    found = spectrum(values)
    power, moment = found.power, found.power * found.frequency
    sums, moments = (np.concatenate(([0.0], np.cumsum(each))) for each in (power, moment))
    highest = len(values) / MIN_SAMPLES_PER_PERIOD / CORE[1]
    if highest <= FEWEST_PERIODS:
        return None
    best = None
    for line in np.unique(np.round(np.geomspace(FEWEST_PERIODS, highest, CENTRES)).astype(int)).tolist():
        peak, lines = _within(sums, line, CORE)
        below, fewer = _within(sums, line, BELOW)
        above, more = _within(sums, line, ABOVE)
        share = peak / sums[-1]
        if share < LEAST_SHARE or min(below, above) <= 0:
            continue
        around = math.sqrt((below / fewer) * (above / more))
        # The power of a line of noise has an exponential distribution: its log a mean over k lines scatters
        # by 1 / sqrt(k).
        scatter = math.sqrt(1 / lines + 0.25 / fewer + 0.25 / more)
        clear = math.log(peak / lines / around / BEND) / scatter
        if best is None or clear > best[0]:
            best = (clear, peak / _within(moments, line, CORE)[0], share)
    return best


def _within(sums: FloatArray, line: int, band: tuple[float, float]) -> tuple[float, int]:
    """Return power and number of the lines in a band of frequencies about ``line``, at least one."""
    first = min(max(1, math.ceil(line * band[0])), len(sums) - 2)
    last = min(max(first, math.floor(line * band[1])), len(sums) - 2)
    return float(sums[last + 1] - sums[first]), last - first + 1
