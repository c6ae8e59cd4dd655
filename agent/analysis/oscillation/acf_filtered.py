"""Several oscillations in one record: each peak of the spectrum filtered, then its autocorrelation judged.

Source: N. F. Thornhill, B. Huang and H. Zhang, "Detection of multiple oscillations in control loops", Journal
of Process Control 13 (2003) 91; reference ``methods.md`` 2.3. Behind a band-pass noise crosses zero regularly
too. So the peak must stand above its surroundings, and the swings of the autocorrelation beyond what white
noise shows behind the same filter; both tests are ours.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache
from typing import TYPE_CHECKING

import numpy as np
from scipy import signal

from agent.analysis.oscillation.acf_zero_crossings import (
    MIN_SAMPLES_PER_PERIOD,
    TWO_SIDED_95,
    Autocorrelation,
    autocorrelation,
    regular_crossings,
    significant_crossings,
)
from agent.analysis.oscillation.spectrum import Spectrum, bridged, spectrum
from agent.analysis.record.recording import LoopWindow
from agent.analysis.record.signals import detrended
from agent.analysis.results import Oscillation

if TYPE_CHECKING:
    from collections.abc import Iterator

    from agent.analysis.record.recording import FloatArray

FEWEST_PERIODS = 4
"""The autocorrelation needs so many in the record."""
LEAST_SHARE = 0.01
"""Part of the power below which a component is ignored (Thornhill 2003)."""
LEAST_PROMINENCE = 5.0
"""Density of power of a peak over that of its surroundings. With 5 one in a hundred of 640 simulated
records of noise, drift and sound loops (``simulators.draws.random_plants``, seeds 0 to 39) passes both tests;
with 4 twice as many."""
WIDTH = 1.7
"""Edges of the band-pass, in parts of the frequency of the peak: a factor to each side. With 1.4 short
oscillations (8 periods) are lost, with 2 noise passes."""
TAKEN = 2**0.5
"""A peak takes half an octave to each side; the next one is looked for beyond."""
MOST_PEAKS = 8
SAME = 0.1
"""Periods that differ by less are those of one oscillation."""
HARMONICS = np.arange(2, 8)
HARMONIC = 0.05
"""How far the period of a harmonic may be off."""
POINTS = 100
"""Points a period at which the correlation of filtered noise is tabled."""
TABLED = 12
"""Periods after which it is forgotten."""


@dataclass(frozen=True, slots=True)
class AcfFiltered:
    """Answers with the strongest oscillation of the record."""

    name: str = "acf_filtered"
    noise_proof: bool = True

    def detect(self, window: LoopWindow) -> Oscillation:
        """Judge a window of at least four periods."""
        return next(iter(oscillations(window)), Oscillation(detected=False, period=None, regularity=None))


def oscillations(window: LoopWindow) -> tuple[Oscillation, ...]:
    """Return every oscillation of the control error or of OP, the largest part of its signal's power first.

    An oscillation whose period is a whole fraction of a stronger one's is a harmonic and is left out.
    """
    found = [each for values in (window.error, window.op) for each in components(values, window.ts)]
    kept: list[Oscillation] = []
    for one in sorted(found, key=lambda each: -(each.share or 0.0)):
        if not any(_belongs(one, stronger) for stronger in kept):
            kept.append(one)
    return tuple(kept)


def _belongs(one: Oscillation, stronger: Oscillation) -> bool:
    """Return whether ``one`` is the same oscillation as ``stronger`` or a harmonic of it."""
    ratio = (stronger.period or 0.0) / (one.period or np.inf)
    same = abs(ratio - 1) < SAME
    return same or bool(np.any(np.abs(ratio / HARMONICS - 1) < HARMONIC))


def components(values: FloatArray, ts: float) -> Iterator[Oscillation]:
    """Yield the oscillations in one signal (n,), NaN where it has gaps; ``ts`` in s."""
    rest = detrended(values)
    whole = bridged(rest)
    if whole is None:
        return
    gaps = np.isnan(rest)
    found = spectrum(whole)
    for line in peaks(found):
        share = found.share(line)
        if share < LEAST_SHARE or found.prominence(line) < LEAST_PROMINENCE:
            continue
        period = found.period(line)
        filtered = band_passed(whole, period)
        filtered[gaps] = np.nan  # the filter needs a line across a gap, the correlation does not
        acf = autocorrelation(filtered)
        if acf is None:
            continue
        seen = regular_crossings(significant_crossings(acf, _swing_of_filtered_noise(acf, period)), ts)
        if seen.detected:
            yield replace(seen, share=share)


def peaks(found: Spectrum) -> Iterator[int]:
    """Yield the lines of the highest peaks, by power an octave: so drift does not hide what is faster."""
    height = found.power * found.frequency
    height[:FEWEST_PERIODS] = 0.0
    height[found.frequency > 1 / MIN_SAMPLES_PER_PERIOD] = 0.0
    for _ in range(MOST_PEAKS):
        line = int(np.argmax(height))
        if height[line] <= 0:
            return
        yield line
        height[int(np.ceil(line / TAKEN)) : int(line * TAKEN) + 1] = 0.0


def band_passed(values: FloatArray, period: float) -> FloatArray:
    """Return ``values`` (n,), no gaps, through a band-pass at ``period`` (samples, >= 5), without phase."""
    edges = (2 / (WIDTH * period), min(2 * WIDTH / period, 0.95))
    sections = signal.butter(2, edges, btype="bandpass", output="sos")
    padding = min(round(3 * period), len(values) - 1)
    return np.asarray(signal.sosfiltfilt(sections, values, padlen=padding), dtype=np.float64)


def _swing_of_filtered_noise(acf: Autocorrelation, period: float) -> FloatArray:
    """Return how far the ACF of white noise swings behind the band-pass, shape of ``acf.r``.

    Its own correlation and, by Bartlett, the scatter of an estimate, which vanishes where the correlation
    is 1.
    """
    table = _correlation_of_filtered_noise()
    lags = POINTS * np.arange(len(acf.r)) / period
    rho = np.interp(lags, np.arange(table.size), table, right=0.0)
    memory = period / POINTS * (1 + 2 * float(np.sum(table[1:] ** 2)))
    scatter = TWO_SIDED_95 * np.sqrt(memory / acf.pairs) * (1 - rho**2)
    return np.asarray(np.abs(rho) + scatter, dtype=np.float64)


@cache
def _correlation_of_filtered_noise() -> FloatArray:
    """Return the ACF of white noise behind the band-pass at ``POINTS`` lags a period, (TABLED * POINTS,)."""
    impulse = np.zeros(2 * TABLED * POINTS + 1)
    impulse[TABLED * POINTS] = 1.0
    response = band_passed(impulse, POINTS)
    products = signal.correlate(response, response)[response.size - 1 :][: TABLED * POINTS]
    return np.asarray(products / products[0], dtype=np.float64)
