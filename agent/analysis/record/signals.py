"""Preparation that the oscillation detectors share; NaN stays NaN."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agent.analysis.record.recording import FloatArray

ROUND_OFF = 2.0**-23
"""Movement below this part of the largest value is round-off, not the signal: controllers, field buses and
the windows of the agent have floats of 32 bits, and a ramp that is rounded to them seems to oscillate."""
SAMPLING_SD = 1 / math.sqrt(12)
"""Standard deviation of an instant known to one sample, samples."""


def detrended(signal: FloatArray) -> FloatArray:
    """Return ``signal`` less its least-squares line, as a part of its largest value, shape (n,).

    A slow drift would otherwise hide the crossings of zero, and the squares of very large or small units
    would overflow. All NaN where fewer than three samples are finite; exactly zero where only
    round-off remains.
    """
    finite = np.isfinite(signal)
    if np.count_nonzero(finite) < 3:
        return np.full(len(signal), np.nan)
    rest = np.where(finite, signal, np.nan)
    largest = np.nanmax(np.abs(rest))
    if largest == 0:
        return rest
    rest /= largest
    time = np.linspace(-1.0, 1.0, len(signal))
    time -= np.mean(time[finite])
    known, at = rest[finite], time[finite]
    mean = np.mean(known)
    rest -= mean + time * (at @ (known - mean) / (at @ at))
    rest[np.abs(rest) < ROUND_OFF] = 0.0
    return rest


def noise_level(signal: FloatArray) -> float:
    """Return the standard deviation of white noise that would explain the second differences of ``signal``.

    Second differences see little of a slow wave and all of the noise: their variance is 6 times its own.
    0 where no three samples in a row are finite.
    """
    bends = np.diff(signal, n=2)
    bends = bends[np.isfinite(bends)]
    return float(np.sqrt(np.mean(bends**2) / 6)) if bends.size else 0.0


def regularity(periods: Sequence[float] | FloatArray, ts: float) -> float:
    """Return mean over three standard deviations of the periods (s); > 1 is regular (Thornhill 2003).

    A period is known no better than to a sample, so that a perfect wave stays finite.
    """
    deviation = max(float(np.std(periods, ddof=1)), SAMPLING_SD * ts)
    return float(np.mean(periods)) / (3 * deviation)
