"""Half cycles cut from a stream of samples, one at a time, in bounded memory.

Source: reference ``methods.md`` 4.10.
"""

from __future__ import annotations

import math
import statistics
from array import array
from collections import deque
from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.stiction.shapes.half_cycle_shapes import POINTS, resampled
from agent.analysis.stiction.shapes.stretch import smoothed

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray

LONGEST = 20_000
"""Samples of a half cycle that are kept; a longer one starts anew."""
DEAD_BAND = 0.3
"""Deviation from the mean, over the standard deviation, below which a sample crosses nothing."""
MEMORY = 20
"""Half cycles over which mean and standard deviation are taken."""
LATEST = 10
"""Half cycles whose length is remembered."""
USUAL = (0.5, 2.0)
"""Shortest and longest half cycle that counts, over the median of the latest."""
_NEIGHBOUR = -np.eye(POINTS)[:, ::-1]
"""The half cycles to both sides, as far as one can know: the same turned over."""
LOW_PASS = smoothed(np.hstack([_NEIGHBOUR, np.eye(POINTS), _NEIGHBOUR]), 2 * POINTS)[:, POINTS : 2 * POINTS]
"""The low-pass of the batch detectors as a matrix, for half cycles of 100 points, (100, 100)."""


class HalfCycleStream:
    """Cuts a signal where it crosses its own slow mean. A gap starts anew, but the mean is kept."""

    def __init__(self) -> None:
        self._mean = 0.0
        self._variance = 0.0
        self._samples = 0
        self._lengths: deque[int] = deque(maxlen=LATEST)
        """Samples of the latest half cycles."""
        self._restart()

    def _restart(self) -> None:
        self._side = 0
        self._whole = False
        self._values = array("d")  # a list of floats takes five times the memory

    def push(self, value: float) -> FloatArray | None:
        """Take the next sample, NaN for a gap; return the half cycle it ends, (100,), without its sign."""
        if not math.isfinite(value) or len(self._values) > LONGEST:
            self._restart()
            return None
        deviation = self._deviation(value)
        self._values.append(deviation)
        if abs(deviation) <= DEAD_BAND * math.sqrt(self._variance) or deviation * self._side > 0:
            return None
        return self._cross(1 if deviation > 0 else -1)

    def _deviation(self, value: float) -> float:
        """Update mean and variance by ``value`` (Welford's recursion); return how far it is from the mean.

        What they forget depends on the longest half cycle: the first ones may be fragments of noise.
        """
        memory = MEMORY * max(self._lengths) if self._lengths else math.inf
        self._samples = int(min(self._samples + 1, memory))
        before = value - self._mean
        self._mean += before / self._samples
        after = value - self._mean
        self._variance += (before * after - self._variance) / self._samples
        return after

    def _cross(self, side: int) -> FloatArray | None:
        """Go over to ``side``: the half cycle ends at the last change of sign before."""
        values, was_whole = np.array(self._values), self._whole
        opposite = np.flatnonzero(values * side < 0)
        last = int(opposite[-1]) if opposite.size else 0
        self._whole = self._side != 0  # what came before the first crossing is a part only
        self._side = side
        self._values = self._values[last:]
        if not was_whole:
            return None
        self._lengths.append(last)
        usual = statistics.median(self._lengths)
        if not USUAL[0] * usual <= last <= USUAL[1] * usual:
            return None
        return np.maximum(resampled(values[: last + 2]) @ LOW_PASS, 0.0)
