"""At which time a sample counts: that of its source, unless the source's clock cannot be right.

Windows take source time, whatever a clock in the field is off, as long as it ticks. Three things would spoil
them: a clock that is absurd (2000-01-01 after an empty battery), a single time that leaps (a flipped bit, a
wrong unit), and a missing value, which often bears the time of this machine and not of the source. PV and OP
may come from sources of their own, so each role has its clock; one that was set is believed at once where the
clock of another role shows the same.
"""

from __future__ import annotations

import logging
import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from agent.runtime.intake.window import LAST_TIME
from connectors.base import Quality, Sample

if TYPE_CHECKING:
    from agent.runtime.intake.rows import ValueRows

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


@dataclass(slots=True)
class _Track:
    """Times of one role, or of the whole loop."""

    newest: float = math.nan
    """Newest time that was believed, s UTC."""
    arrival: float = math.nan
    """When it came, monotonic, s."""
    offset: float | None = None
    """What is added to absurd times, s; None while they are not."""
    leap: tuple[float, float] | None = None
    """Time and arrival of the first of those in a row that do not go on from the newest."""

    def expected(self, arrival: float) -> float:
        """Return what the clock must show at ``arrival``, s UTC; NaN before the first time."""
        return self.newest + arrival - self.arrival

    def doubts(self, time: float, arrival: float) -> bool:
        """Return whether a time leaps from the newest; never before the first."""
        expected = self.expected(arrival)
        return time > expected + LEAP or (time <= self.newest and time < expected - LEAP)

    def follow(self, time: float, arrival: float, *, set_back: bool) -> None:
        """Go on from a time that is believed; one from the past is on its way late, unless set back."""
        if set_back or not time <= self.newest:
            self.newest, self.arrival = time, arrival


class SourceClock:
    """The clocks behind the samples of one loop."""

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
        self._any = _Track()
        self._roles: dict[str, _Track] = {}
        self._logged = math.nan
        """When the log last had that a clock is off, s UTC."""
        self._said = False
        """Whether it had it this time."""

    def checked(self, sample: Sample, arrival: float) -> Sample | None:
        """Return the sample with the time that counts, None where it should be dropped.

        ``arrival`` is monotonic, s. What is no time at all is left to the window.
        """
        if not abs(sample.time) <= LAST_TIME:  # nor NaN
            return sample
        own = self._roles.setdefault(sample.tag.role, _Track())
        known = self._any if math.isnan(own.newest) else own
        expected = known.expected(arrival)  # NaN before the first
        absurd = abs(sample.time - self._now()) > self._limit
        if sample.quality is Quality.BAD and (absurd or sample.time > expected + EARLY):
            # Most such times are this machine's; before the first value there is nothing to compare with.
            return sample if math.isnan(expected) else replace(sample, time=expected)
        time = self._here(own, sample.time) if absurd else self._believed(own, sample.time)
        doubted = known.doubts(time, arrival)
        if doubted and self._any.doubts(time, arrival) and not _goes_on(own, time, arrival):
            leaps = time > expected + LEAP
            self.leaps += leaps
            return None if leaps else replace(sample, time=time)
        own.leap = None
        own.follow(time, arrival, set_back=doubted)
        self._any.follow(time, arrival, set_back=doubted)
        return replace(sample, time=time) if absurd else sample

    def follows(self, rows: ValueRows) -> bool:
        """Follow rows whose times are all believed, as ``checked`` does one by one; else return False.

        The times increase. An absurd one, a leap or a role that was not seen yet needs a look of its own.
        """
        tracks = [self._roles.get(role) for role in rows.roles]
        times, arrivals = rows.times.source, rows.times.arrivals
        if rows.times.leap > LEAP or rows.times.off(self._now()) > self._limit:
            return False
        first, arrival = float(times[0]), float(arrivals[0])
        for own in tracks:
            if own is None or own.offset is not None or not first > own.newest or own.doubts(first, arrival):
                return False
        newest, arrival = float(times[-1]), float(arrivals[-1])
        for own in tracks:
            if own is not None:
                own.leap = None
                own.follow(newest, arrival, set_back=False)
        self._any.follow(newest, arrival, set_back=False)
        return True

    def _believed(self, own: _Track, time: float) -> float:
        if own.offset is not None:
            if self._said:
                LOG.info("%s: the source's clock is believed again", self._loop)
            own.offset = None
        return time

    def _here(self, own: _Track, time: float) -> float:
        """Return an absurd time on this machine's clock; differences stay the source's."""
        now = self._now()
        if own.offset is None:
            off = time - now
            self._said = not abs(now - self._logged) < LOGGED_AGAIN  # NaN before the first
            if self._said:
                self._logged = now
                text = "%s: the source's clock is off by %.0f s, time is taken from here"
                LOG.warning(text, self._loop, off)
            own.offset = -off
        self.absurd += 1
        ahead = time + own.offset - now
        if ahead > 0 or ahead < -LATE:  # it came faster than the ones before, was set, or stands still
            own.offset -= ahead
        return time + own.offset


def _goes_on(own: _Track, time: float, arrival: float) -> bool:
    """Return whether times go on for long enough from the first that leaped: then the clock was set."""
    if own.leap is None or not own.leap[0] <= time <= own.leap[0] + arrival - own.leap[1] + LEAP:
        own.leap = (time, arrival)
    return arrival - own.leap[1] >= CONFIRMED
