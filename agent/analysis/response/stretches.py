"""Stretches of a record that a test of the response looks at."""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from agent.analysis.record.recording import FloatArray

SMOOTH = 5
"""Samples of which the median is taken before a travel is measured: single values are not one."""
NOISE_LAGS = (1, 4, 10)
"""Samples over which noise is compared: white noise is the same at each, noise that lasts is seen at ten."""


def longest_true(mask: NDArray[np.bool_]) -> slice:
    """Return the longest stretch of ``mask`` (n,) that is true; an empty one where none is."""
    edges = np.flatnonzero(np.diff(np.concatenate(([False], mask, [False])).astype(np.int8)))
    starts, ends = edges[::2], edges[1::2]
    if not starts.size:
        return slice(0, 0)
    longest = int(np.argmax(ends - starts))
    return slice(int(starts[longest]), int(ends[longest]))


def longest_within(values: FloatArray, band: float) -> slice:
    """Return the longest stretch of ``values`` (n,), finite, that stays within ``band``."""
    highs: deque[int] = deque()
    lows: deque[int] = deque()
    begin, best = 0, slice(0, 0)
    for k, value in enumerate(values.tolist()):
        while highs and values[highs[-1]] <= value:
            highs.pop()
        while lows and values[lows[-1]] >= value:
            lows.pop()
        highs.append(k)
        lows.append(k)
        while values[highs[0]] - values[lows[0]] > band:
            begin += 1
            if highs[0] < begin:
                highs.popleft()
            if lows[0] < begin:
                lows.popleft()
        if k + 1 - begin > best.stop - best.start:
            best = slice(begin, k + 1)
    return best


def smoothed(values: FloatArray, samples: int = SMOOTH) -> FloatArray:
    """Return the running median of a signal (n,) over an odd number of samples, (n,); ends are repeated."""
    half = samples // 2
    padded = np.pad(values, half, mode="edge")
    return np.asarray(np.median(np.lib.stride_tricks.sliding_window_view(padded, samples), axis=1))


def travelled(values: FloatArray) -> float:
    """Return the span of a signal (n,), n >= 1 and finite, without single values that stand out, its unit."""
    if len(values) < SMOOTH:
        return float(np.ptp(values))
    return float(np.ptp(smoothed(values)))


def noise_of(values: FloatArray, lag: int = 1) -> float:
    """Return the standard deviation of the noise of a signal (n,), seen over a lag (samples); 0: it rests."""
    if len(values) < 2 * lag + 1:
        return 0.0
    turns = values[2 * lag :] - 2 * values[lag:-lag] + values[: -2 * lag]
    return 1.4826 * float(np.median(np.abs(turns))) / 6**0.5


def slow_noise_of(values: FloatArray) -> float:
    """Return the same for noise that lasts for some samples: the largest over ``NOISE_LAGS``."""
    return max(noise_of(values, lag) for lag in NOISE_LAGS)


def next_stand(values: FloatArray, stand: slice, band: float) -> slice:
    """Return the longest stretch within ``band`` after a stand, among as many samples as the stand has."""
    after = slice(stand.stop, min(len(values), 2 * stand.stop - stand.start))
    found = longest_within(values[after], band)
    return slice(after.start + found.start, after.start + found.stop)


def stand_before(values: FloatArray, stand: slice, band: float) -> slice:
    """Return the same of the samples before it."""
    n = len(values)
    found = next_stand(values[::-1], slice(n - stand.stop, n - stand.start), band)
    return slice(n - found.stop, n - found.start)
