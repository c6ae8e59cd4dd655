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


def smoothed(values: FloatArray) -> FloatArray:
    """Return the running median of a signal (n,), n >= ``SMOOTH``, (n,); its ends are repeated."""
    half = SMOOTH // 2
    padded = np.pad(values, half, mode="edge")
    return np.asarray(np.median(np.lib.stride_tricks.sliding_window_view(padded, SMOOTH), axis=1))


def travelled(values: FloatArray) -> float:
    """Return the span of a signal (n,), n >= 1 and finite, without single values that stand out, its unit."""
    if len(values) < SMOOTH:
        return float(np.ptp(values))
    return float(np.ptp(smoothed(values)))


def noise_of(values: FloatArray) -> float:
    """Return the standard deviation of the noise of a signal (n,) from sample to sample; 0 where it rests."""
    if len(values) < 3:
        return 0.0
    return 1.4826 * float(np.median(np.abs(np.diff(values, 2)))) / 6**0.5
