"""At which time a sample counts: that of its source, unless the source's clock cannot be right.

Windows take source time, whatever a clock in the field is off, as long as it ticks. Three things would spoil
them: a clock that is absurd (2000-01-01 after an empty battery), a single time that leaps (a flipped bit, a
wrong unit), and a missing value, which often bears the time of this machine and not of the source.
"""

from __future__ import annotations

import logging
import math
from collections.abc import Callable
from dataclasses import replace

from agent.runtime.loop.window import LAST_TIME
from connectors.base import Quality, Sample

LOG = logging.getLogger(__name__)
LEAP = 60.0
"""A time that is ahead of the clock so far by more than this is not believed at once, s."""
CONFIRMED = 1.0
"""Time over which later times must go on from a leap until it is believed, s: then the clock was set."""
LATE = 60.0
"""Longest time for which a sample may be on its way, s."""
LOGGED_AGAIN = 600.0
"""Time in which the log has once that a clock is off, s: a source may alternate with every message."""
EARLY = 2.0
"""How much the time of a missing value may be ahead of what the source's clock must show, s."""


class SourceClock:
    """The clock behind the samples of one loop."""

    def __init__(self, loop: str, limit: float, now: Callable[[], float]) -> None:
        """Make a clock that was not seen yet.

        Args:
            loop: Name, for the log.
            limit: Difference from this machine's clock from which a source time is absurd, s.
            now: This machine's clock, s UTC.
        """
        self.absurd = 0
        """Samples that got this machine's time."""
        self.leaps = 0
        """Samples that were dropped because their time leaped."""
        self._loop = loop
        self._limit = limit
        self._now = now
        self._newest = math.nan
        """Newest time that was believed, s UTC."""
        self._arrival = math.nan
        """When it came, monotonic, s."""
        self._offset: float | None = None
        """What is added to absurd times, s; None while they are not."""
        self._logged = math.nan
        """When the log last had that the clock is off, s UTC."""
        self._said = False
        """Whether it had it this time."""
        self._leap: tuple[float, float] | None = None
        """Time and arrival of the first of those in a row that do not go on from the newest."""

    def checked(self, sample: Sample, arrival: float) -> Sample | None:
        """Return the sample with the time that counts, None where it should be dropped.

        ``arrival`` is monotonic, s. What is no time at all is left to the window.
        """
        if not abs(sample.time) <= LAST_TIME:  # nor NaN
            return sample
        expected = self._newest + arrival - self._arrival  # NaN before the first
        absurd = abs(sample.time - self._now()) > self._limit
        if sample.quality is Quality.BAD and (absurd or sample.time > expected + EARLY):
            # Most such times are this machine's; before the first value there is nothing to compare with.
            return sample if math.isnan(expected) else replace(sample, time=expected)
        time = self._here(sample.time) if absurd else self._believed(sample.time)
        leaps, is_old = time > expected + LEAP, time <= self._newest
        if leaps or (is_old and time < expected - LEAP):
            if not self._goes_on(time, arrival):
                self.leaps += leaps
                return None if leaps else replace(sample, time=time)
            is_old = False
        self._leap = None
        if not is_old:
            self._newest, self._arrival = time, arrival
        return replace(sample, time=time) if absurd else sample

    def _believed(self, time: float) -> float:
        if self._offset is not None:
            if self._said:
                LOG.info("%s: the source's clock is believed again", self._loop)
            self._offset = None
        return time

    def _here(self, time: float) -> float:
        """Return an absurd time on this machine's clock; differences stay the source's."""
        now = self._now()
        if self._offset is None:
            off = time - now
            self._said = not abs(now - self._logged) < LOGGED_AGAIN  # NaN before the first
            if self._said:
                self._logged = now
                text = "%s: the source's clock is off by %.0f s, time is taken from here"
                LOG.warning(text, self._loop, off)
            self._offset = -off
        self.absurd += 1
        ahead = time + self._offset - now
        if ahead > 0 or ahead < -LATE:  # it came faster than the ones before, was set, or stands still
            self._offset -= ahead
        return time + self._offset

    def _goes_on(self, time: float, arrival: float) -> bool:
        """Return whether times go on for long enough from the first that leaped: then the clock was set."""
        if self._leap is None or not self._leap[0] <= time <= self._leap[0] + arrival - self._leap[1] + LEAP:
            self._leap = (time, arrival)
        return arrival - self._leap[1] >= CONFIRMED
