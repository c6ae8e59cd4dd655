"""Signals with the spectrum of another and phases by chance, as a linear Gaussian process could make them.

Source: J. Theiler and others, "Testing for nonlinearity in time series: the method of surrogate data",
Physica D 58 (1992) 77; ends matched after C. J. Stam, J. P. M. Pijn and W. S. Pritchard (1998), reference
``methods.md`` 3.12. The transform takes a record as one period of an endless signal. Where its end does not
fit its start, the line of an oscillation is smeared, each surrogate beats, and a mere sine looks nonlinear.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from scipy import fft

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray


def ends_matched(x: FloatArray, cycle: int, margin: int) -> FloatArray:
    """Return the part of ``x`` (n,) whose end goes on as it began.

    What follows the part is most like its first cycle, in the mean of squares over a whole cycle: two samples
    alone, value and slope, would follow the noise.

    Args:
        x: Standardised signal without gaps.
        cycle: Samples in a cycle.
        margin: Most samples to cut off at each end, besides the cycle that follows; at least half a cycle.
    """
    stretches = sliding_window_view(x, cycle)
    starts, ends = stretches[:margin], stretches[-margin:]
    apart = np.sum(starts**2, axis=1)[:, None] + np.sum(ends**2, axis=1) - 2 * starts @ ends.T
    # Rounded, for ties are common in quantised signals and must fall alike in all units.
    start, end = np.unravel_index(int(np.argmin(np.round(apart, 9))), apart.shape)
    return x[int(start) : len(stretches) - margin + int(end)]


def surrogates(x: FloatArray, count: int, seed: int) -> FloatArray:
    """Return ``count`` surrogates of ``x`` (n,), (count, n): its amplitudes, random phases, no mean."""
    amplitude = np.abs(fft.rfft(x))
    amplitude[0] = 0.0
    phase = np.random.default_rng(seed).uniform(0.0, 2 * np.pi, (count, len(amplitude)))
    if len(x) % 2 == 0:
        phase[:, -1] = 0.0  # the Nyquist frequency has no phase
    return np.asarray(fft.irfft(amplitude * np.exp(1j * phase), len(x)))
