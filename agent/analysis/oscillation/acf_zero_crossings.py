"""Regular zero crossings of the autocorrelation function.

Source: N. F. Thornhill, B. Huang and H. Zhang, "Detection of multiple oscillations in control loops",
Journal of Process Control 13 (2003) 91; reference ``methods.md`` 2.3. Lags that count: Bartlett (1946).
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from scipy import fft

from agent.analysis.record.recording import LoopWindow
from agent.analysis.record.signals import detrended, regularity
from agent.analysis.results import Oscillation

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray

CROSSINGS = 11
"""Zero crossings that are looked at (Thornhill 2003)."""
MIN_CROSSINGS = 4
"""Three intervals are the fewest that have a spread."""
MIN_SAMPLES_PER_PERIOD = 5.0
"""Faster waves cannot be distinguished from sampling and quantisation."""
TWO_SIDED_95 = 1.96
"""Standard normal deviate of a two-sided 5 % test."""


@dataclass(frozen=True, slots=True)
class Autocorrelation:
    """Autocorrelation of a series with gaps, at lags 0, 1, ... up to half its length."""

    r: FloatArray
    """Correlation coefficients, r[0] = 1."""
    pairs: FloatArray
    """Pairs of finite samples behind each."""


def autocorrelation(signal: FloatArray) -> Autocorrelation | None:
    """Return the autocorrelation of ``signal`` (n,) about zero, each lag over the pairs that are there.

    None where the signal is constant or has fewer than two finite samples.
    """
    finite = np.isfinite(signal)
    if np.count_nonzero(finite) < 2:
        return None
    values = np.where(finite, signal, 0.0)
    if not values.any():
        return None
    lags = len(signal) // 2 + 1
    products = _lagged_products(values, lags)
    pairs = np.maximum(np.rint(_lagged_products(finite.astype(np.float64), lags)), 1.0)
    mean = products / pairs
    return Autocorrelation(mean / mean[0], pairs)


def _lagged_products(values: FloatArray, lags: int) -> FloatArray:
    """Return sum over t of values[t] values[t + k] for k < lags, by FFT."""
    length = fft.next_fast_len(2 * len(values), real=True)
    spectrum = fft.rfft(values, length)
    return np.asarray(fft.irfft(spectrum * spectrum.conj(), length)[:lags], dtype=np.float64)


def swing_of_noise(acf: Autocorrelation) -> FloatArray:
    """Return how far an ACF estimate scatters where the true one is zero (Bartlett), shape of ``acf.r``.

    For noise that is correlated as far as the first crossing of zero; so slow noise is not taken for a wave.
    """
    first = np.flatnonzero(np.signbit(acf.r[:-1]) != np.signbit(acf.r[1:]))[:1].sum()
    memory = 1 + 2 * float(np.sum(acf.r[1 : first + 1] ** 2))
    return np.asarray(TWO_SIDED_95 * np.sqrt(memory / acf.pairs), dtype=np.float64)


def significant_crossings(acf: Autocorrelation, chance: FloatArray) -> FloatArray:
    """Return the lags (samples) where the ACF crosses zero while it swings beyond ``chance`` between."""
    r = acf.r
    before = np.flatnonzero(np.signbit(r[:-1]) != np.signbit(r[1:]))
    if before.size == 0:
        return np.empty(0)
    swings = (np.max(np.abs(r[a + 1 : b + 1]) / chance[a + 1 : b + 1]) > 1 for a, b in pairwise(before))
    count = 1
    for significant in swings:
        if not significant:
            break
        count += 1
    k = before[: min(count, CROSSINGS)]
    return np.asarray(k + r[k] / (r[k] - r[k + 1]), dtype=np.float64)


def regular_crossings(crossings: FloatArray, ts: float) -> Oscillation:
    """Return the oscillation that the lags (samples) of the crossings show; ``ts`` in s."""
    if len(crossings) < MIN_CROSSINGS:
        return Oscillation(detected=False, period=None, regularity=None)
    periods = 2 * ts * np.diff(crossings)
    period = float(np.mean(periods))
    regular = regularity(periods, ts)
    return Oscillation(regular > 1 and period >= MIN_SAMPLES_PER_PERIOD * ts, period, regular)


def acf_oscillation(signal: FloatArray, ts: float) -> Oscillation:
    """Return the oscillation that the zero crossings of the ACF of ``signal`` (n,) show; ``ts`` in s."""
    acf = autocorrelation(detrended(signal))
    crossings = np.empty(0) if acf is None else significant_crossings(acf, swing_of_noise(acf))
    return regular_crossings(crossings, ts)


@dataclass(frozen=True, slots=True)
class AcfZeroCrossings:
    """Looks at the control error and at OP and answers with the more regular one."""

    name: str = "acf_zero_crossings"
    noise_proof: bool = True

    def detect(self, window: LoopWindow) -> Oscillation:
        """Judge a window of at least four periods."""
        seen = [acf_oscillation(signal, window.ts) for signal in (window.error, window.op)]
        return max(seen, key=lambda oscillation: (oscillation.detected, oscillation.regularity or 0.0))
