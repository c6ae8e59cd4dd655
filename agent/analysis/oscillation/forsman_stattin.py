"""Half cycles of the control error that resemble the last one on the same side.

Source: K. Forsman and A. Stattin, "A new criterion for detecting oscillations in control loops", European
Control Conference (1999); reference ``methods.md`` 2.2, from memory of the paper, which gives ranges for
the two limits; their middles are taken.
"""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass

from agent.analysis.oscillation.hagglund import MIN_PERIODS, NOISE_SIGMAS, HalfCycle, HalfCycles, half_cycles
from agent.analysis.record.recording import LoopWindow
from agent.analysis.record.signals import detrended, noise_level, regularity
from agent.analysis.results import Oscillation

ALPHA = 0.6
"""Smallest ratio of two areas that are alike; the paper says 0.5 to 0.7."""
GAMMA = 0.75
"""Smallest ratio of two durations that are alike; the paper says 0.7 to 0.8."""
CLEAR = 0.8
"""Share of half cycles alike from which the oscillation is clear; from 0.4 the paper calls it a candidate."""


def alike(one: HalfCycle, other: HalfCycle) -> bool:
    """Return whether two half cycles have about the same area and the same duration."""
    areas, durations = (one.iae, other.iae), (one.duration, other.duration)
    return min(areas) > ALPHA * max(areas) and min(durations) > GAMMA * max(durations)


class ForsmanStattinMonitor:
    """Online form: the index h after every zero crossing, O(1) a sample, constant memory, no clock."""

    def __init__(self, ts: float, dead_band: float = 0.0, memory: float = math.inf) -> None:
        """Start with no half cycle seen.

        Args:
            ts: Sampling time, s.
            dead_band: Error that noise may reach without crossing zero, PV units.
            memory: Half cycles over which h is taken, > 1; older ones are forgotten exponentially.
            Infinite: h over
                everything, as the paper's.
        """
        self._half_cycles = HalfCycles(ts, dead_band)
        self._memory = memory
        self._last_two: deque[HalfCycle] = deque(maxlen=2)
        self._crossings = 0
        self._index = 0.0

    @property
    def index(self) -> float:
        """The share h of half cycles that resemble the last one on their side, 0 to 1."""
        return self._index

    def push(self, error: float) -> HalfCycle | None:
        """Take the next error SP - PV (PV units); return the half cycle it ends. A gap (NaN) starts anew."""
        if not math.isfinite(error):
            self._last_two.clear()
        ended = self._half_cycles.push(error)
        if ended is not None:
            self.take(ended)
        return ended

    def take(self, ended: HalfCycle, *, gap: bool = False) -> None:
        """Take the next half cycle; ``gap``: there is one before it."""
        if gap:
            self._last_two.clear()
        resembles = len(self._last_two) == 2 and alike(self._last_two[0], ended)
        self._last_two.append(ended)
        self._crossings += 1
        self._index += (resembles - self._index) / min(self._crossings, self._memory)


@dataclass(frozen=True, slots=True)
class ForsmanStattin:
    """Batch form on the error of a window: h over all of it."""

    name: str = "forsman_stattin"
    noise_proof: bool = True

    def detect(self, window: LoopWindow) -> Oscillation:
        """Judge a window of at least five periods: with fewer h cannot exceed 0.8."""
        error = detrended(window.error)
        monitor, ends, former = ForsmanStattinMonitor(window.ts), [], 0
        for _, gaps, ended in half_cycles(error, window.ts, NOISE_SIGMAS * noise_level(error)):
            monitor.take(ended, gap=gaps != former)
            ends.append(ended.duration)
            former = gaps
        periods = [rise + fall for rise, fall in zip(ends[::2], ends[1::2], strict=False)]
        if len(periods) < MIN_PERIODS:
            return Oscillation(detected=False, period=None, regularity=None)
        return Oscillation(monitor.index > CLEAR, sum(periods) / len(periods), regularity(periods, window.ts))
