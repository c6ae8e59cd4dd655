"""S of a valve day by day: the windows of a day in one number with its standard deviation."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.results import NORMAL_90

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agent.analysis.diagnosis import Diagnosis

FEWEST, NEWEST = 2, 5
"""Days that must have shown S before it is known, and the newest that count: S of a month ago may be worn."""
MOST_DAYS = 120
"""Days that are kept; of more, the two nearest of the older half become one."""
DAY = 86400.0
"""s"""
LEAST_SD = 0.02
"""Smallest standard deviation, part of S: what the models lack is in all windows."""
WRONG = 0.05
"""Probability that a search finds no stiction in a window that shows it."""
REPAIRED = 0.5
"""Part of its former S below which a valve does not stick as before: what is called a repair."""
TRUST = 0.5
"""Part of the nats for the former S that counts: the models lack something in each window."""
MOST = 5.0
"""Nats that a day has at most against the former S: of the windows of constant valves that are recognised one
in 150 contradicts it clearly."""
MOST_FOR = 3.0
"""And for it: a load that the controller cancels looks like a stem that stands."""
SHOWS = 0.5
"""Probability from which a window shows how much its valve sticks; below, S is what a search found."""


@dataclass(frozen=True, slots=True)
class SDay:
    """S of one day."""

    time: float
    """Of the newest window, s UTC."""
    s: float
    """OP units."""
    sd: float
    """Its standard deviation, OP units."""
    weight: float
    """Windows that it comes from, each by what was new in it."""
    above: float | None = None
    """None where the windows show S. Else they only divide: log of how much likelier they are where S is
    above ``bound`` than where it is below; 0 where no search found anything."""
    half: float = 0.0
    """The part of the former S that a comparison with it divides at, OP units."""
    agrees: float | None = None
    """Nats by which the windows are likelier with the former S than without friction; None: not compared."""

    @property
    def bound(self) -> float:
        """The upper end of what a search found, OP units."""
        return self.s + 2 * self.sd

    def divided(self, *, recognised: bool) -> tuple[tuple[float, float], ...]:
        """Return what divides S, OP units, and by how many nats it is above that rather than below.

        Where a search and the comparison with the former S both speak for less, S above the bound is as
        unlikely as the search says, and S above half of the former one as the clearer of both says: they
        come from the same windows, so they do not add up.

        Args:
            recognised: Whether comparisons with the former S are right for this valve.
        """
        found = self.above or 0.0
        if not recognised or self.agrees is None:
            return ((self.bound, found),)
        if self.bound < self.half and found < 0 and self.agrees < 0:
            both = min(self.agrees, found)
            at_bound = found if self.agrees < found else found - self.agrees
            return (self.bound, at_bound), (self.half, both - at_bound)
        return ((self.half, self.agrees),)


def s_seen(diagnosis: Diagnosis, time: float) -> SDay | None:
    """Return S of a window; None where it has no fit with S.

    Where a window does not show that its valve sticks, it may show that S is below a bound: so a repair is
    seen.
    """
    found, before = diagnosis.quantification, diagnosis.as_before
    stiction = None if found is None else found.stiction
    s = (None, None, None) if stiction is None else (stiction.s.value, stiction.s.low, stiction.s.high)
    alone = None if diagnosis.weighed is None else diagnosis.weighed.probability
    shows = None if found is None else found.would_show
    return s_of_window(time, s, alone, None if before is None else (before.s, before.log_ratio), shows)


def s_of_window(
    time: float,
    s: tuple[float | None, float | None, float | None],
    probability: float | None,
    before: tuple[float, float] | None = None,
    would_show: float | None = None,
) -> SDay | None:
    """Return S of a window from its numbers, as a history has them; None where they are not known.

    Args:
        time: End of the window, s UTC.
        s: S with the ends of its 90 % interval, OP units.
        probability: That the valve sticks, from this window alone.
        before: The former S, and by how much likelier the window is with it than without friction
            (``AsBefore``), OP units and nats; None where that is not known.
        would_show: How likely the window shows a valve that sticks, and so whether finding none bounds S.
    """
    value, low, high = s
    found = None
    if value is not None and low is not None and high is not None and probability is not None:
        least = max(LEAST_SD * value, 1e-6)
        if probability > SHOWS:
            found = SDay(time, value, max((high - low) / (2 * NORMAL_90), least), 1.0)
        else:
            missed = 1.0 - (1.0 if would_show is None else would_show) * (1.0 - WRONG)
            found = SDay(time, value, max((high - value) / 2, least), 1.0, above=math.log(missed))
    if before is None:
        return found
    half, agrees = REPAIRED * before[0], max(-MOST, min(MOST_FOR, TRUST * before[1]))
    if found is None:
        return SDay(time, half, 0.0, 1.0, 0.0, half, agrees)
    if found.above is None and found.s < half:
        return found  # it was repaired, and shows it: the former S must not fit
    return replace(found, half=half, agrees=agrees)


def with_s(days: Sequence[SDay], new: SDay, weight: float) -> tuple[SDay, ...]:
    """Return the days with one more window, which counts by ``weight``."""
    last = days[-1] if days else None
    if last is None or math.floor(last.time / DAY) != math.floor(new.time / DAY):
        return _thinned((*days, replace(new, weight=weight)))
    if (last.above is None) != (new.above is None):  # a day that showed S does not divide it
        return tuple(days) if last.above is None else (*days[:-1], replace(new, weight=weight))
    return (*days[:-1], _one_day(last, replace(new, weight=weight)))


def known_s_of(days: Sequence[SDay]) -> float | None:
    """Return the S that the newest days agree on, OP units; None where too few showed it."""
    shown = [each.s for each in days if each.above is None][-NEWEST:]
    return float(np.median(shown)) if len(shown) >= FEWEST else None


def falls(days: Sequence[SDay], seen: SDay) -> bool:
    """Whether a window speaks for an S of less than half of the former one, however little.

    Args:
        days: Days of S with the window.
        seen: What the window shows of S.
    """
    former = known_s_of(days)
    if former is None:
        return False
    if seen.above is None:
        return seen.s < REPAIRED * former
    return any(above < 0 and divides <= former for divides, above in seen.divided(recognised=True))


def _one_day(last: SDay, new: SDay) -> SDay:
    """Return two parts of a day as one: means weighted by windows, S by its precision as well."""
    both = last.weight + new.weight
    searched = [each for each in (last, new) if each.above != 0] or [new]
    found = searched[0]
    if len(searched) == 2:
        precisions = (last.weight / last.sd**2, new.weight / new.sd**2)
        s = (precisions[0] * last.s + precisions[1] * new.s) / sum(precisions)
        above = None
        if last.above is not None and new.above is not None:
            above = (last.weight * last.above + new.weight * new.above) / both
        found = replace(new, s=s, sd=math.sqrt(both / sum(precisions)), above=above)
    compared = [each for each in (last, new) if each.agrees is not None]
    count = sum(each.weight for each in compared)
    half = sum(each.weight * each.half for each in compared) / count if compared else 0.0
    agrees = sum(each.weight * (each.agrees or 0.0) for each in compared) / count if compared else None
    return replace(found, time=new.time, weight=both, half=half, agrees=agrees)


def _thinned(days: tuple[SDay, ...]) -> tuple[SDay, ...]:
    """Return at most ``MOST_DAYS``: every second of the older half goes."""
    if len(days) <= MOST_DAYS:
        return days
    half = MOST_DAYS // 2
    return (*days[:half:2], *days[half:])
