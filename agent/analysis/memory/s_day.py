"""S of a valve day by day: the windows of a day in one number with its standard deviation."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from agent.analysis.results import NORMAL_90

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agent.analysis.diagnosis import Diagnosis

MOST_DAYS = 120
"""Days that are kept; of more, the two nearest of the older half become one."""
DAY = 86400.0
"""s"""
LEAST_SD = 0.02
"""Smallest standard deviation, part of S: what the models lack is in all windows."""
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
    upper: bool = False
    """Whether it is only a bound: the windows show that S is not more than ``bound``."""

    @property
    def bound(self) -> float:
        """Largest S that the windows of a bound allow, OP units."""
        return self.s + 2 * self.sd


def s_seen(diagnosis: Diagnosis, time: float) -> SDay | None:
    """Return S of a window; None where it has no fit with S.

    Where a window does not show that its valve sticks, the upper end of its interval is a bound: so a repair
    is seen.
    """
    found = diagnosis.quantification
    if found is None or found.stiction is None or diagnosis.weighed is None:
        return None
    s = found.stiction.s
    return s_of_window(time, (s.value, s.low, s.high), diagnosis.weighed.probability)


def s_of_window(
    time: float, s: tuple[float | None, float | None, float | None], probability: float | None
) -> SDay | None:
    """Return S of a window from its numbers, as a history has them; None where they are not known.

    Args:
        time: End of the window, s UTC.
        s: S with the ends of its 90 % interval, OP units.
        probability: That the valve sticks, from this window alone.
    """
    value, low, high = s
    if value is None or low is None or high is None or probability is None:
        return None
    least = max(LEAST_SD * value, 1e-6)
    if probability > SHOWS:
        return SDay(time, value, max((high - low) / (2 * NORMAL_90), least), 1.0)
    return SDay(time, value, max((high - value) / 2, least), 1.0, upper=True)


def with_s(days: Sequence[SDay], new: SDay, weight: float) -> tuple[SDay, ...]:
    """Return the days with one more window, which counts by ``weight``."""
    last = days[-1] if days else None
    if last is None or math.floor(last.time / DAY) != math.floor(new.time / DAY):
        return _thinned((*days, SDay(new.time, new.s, new.sd, weight, new.upper)))
    if last.upper != new.upper:  # a day that showed stiction is not a bound
        return tuple(days) if new.upper else (*days[:-1], SDay(new.time, new.s, new.sd, weight))
    precisions = (last.weight / last.sd**2, weight / new.sd**2)
    s = (precisions[0] * last.s + precisions[1] * new.s) / sum(precisions)
    sd = math.sqrt((last.weight + weight) / sum(precisions))
    return (*days[:-1], SDay(new.time, s, sd, last.weight + weight, last.upper))


def _thinned(days: tuple[SDay, ...]) -> tuple[SDay, ...]:
    """Return at most ``MOST_DAYS``: every second of the older half goes."""
    if len(days) <= MOST_DAYS:
        return days
    half = MOST_DAYS // 2
    return (*days[:half:2], *days[half:])
