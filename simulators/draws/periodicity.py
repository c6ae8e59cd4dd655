"""Whether a noise-free signal of a plant really oscillates."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray


def period_and_strength(signal: NDArray[np.float64]) -> tuple[float, float]:
    """Period, in samples, and strength of the oscillation of a signal of shape (n,).

    Both are read at the highest peak of the autocorrelation behind its first crossing of zero: the lag,
    and the height, from 0 for none to 1 for a signal that repeats itself exactly. (0, 0) where it never
    crosses.
    """
    n = signal.size
    power = np.abs(np.fft.rfft(signal - signal.mean(), 2 * n)) ** 2
    lags = n // 2  # beyond, too few products are left to average
    products = np.fft.irfft(power)[:lags]
    acf = products / max(products[0], np.finfo(float).tiny) * n / (n - np.arange(lags))
    below = np.flatnonzero(acf < 0)
    if below.size == 0:
        return 0.0, 0.0
    first = int(below[0])
    peak = first + int(np.argmax(acf[first : 4 * first]))  # a multiple of the period is no period
    return float(peak), float(max(acf[peak], 0.0))
