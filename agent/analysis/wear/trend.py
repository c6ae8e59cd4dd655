"""S of a valve against time: where it jumped, how it rises, when it reaches a limit.

Stretches without a jump, each a local linear trend of the logarithm of S: wear and repair multiply S, and so
do errors of a window. A repair is a jump down. See docs/methods/wear.md.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.results import NORMAL_90
from agent.analysis.wear.filter import Filtered, SeenLevel, forecast
from agent.analysis.wear.stretches import LACKS, UNRECOGNISED, WALK, Kind, follow

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agent.analysis.memory.s_day import SDay

DAY = 86400.0
"""s"""
FEWEST = 3
"""Days below which there is no trend."""
LEAST = 1e-3
"""Least S over its middle that a day may have: below it, one is as good as none."""
FELL = 0.5
"""Part to which S must fall at least where a jump down is called a repair."""
FAR = 3650.0
"""Days ahead beyond which no time is stated."""


@dataclass(frozen=True, slots=True)
class Level:
    """S at one time."""

    time: float
    """s UTC"""
    s: float
    low: float
    high: float
    """OP units, with a 90 % interval; from 0 where the stretch has nothing but bounds."""


@dataclass(frozen=True, slots=True)
class Jump:
    """S was another from a day on."""

    time: float
    """Of the first day after it, s UTC."""
    before: float
    after: float
    """OP units."""

    @property
    def repair(self) -> bool:
        """Whether it was a repair."""
        return self.after <= FELL * self.before


@dataclass(frozen=True, slots=True)
class Trend:
    """How S of a valve went."""

    levels: tuple[Level, ...]
    """As known on each day, from the days up to it."""
    jumps: tuple[Jump, ...]
    slope: float
    slope_low: float
    slope_high: float
    """Of S since the last jump, as it is on the last day, OP units a day, with a 90 % interval."""
    worse_since: float | None
    """Time from which S rises, s UTC; None: it does not rise for certain."""
    last: Filtered

    @property
    def repaired(self) -> float | None:
        """Time of the last repair, s UTC; None: there was none."""
        return next((each.time for each in reversed(self.jumps) if each.repair), None)


@dataclass(frozen=True, slots=True)
class Reached:
    """When S reaches a limit, s UTC; None: not within ten years."""

    limit: float
    """OP units."""
    time: float | None
    low: float | None
    """Earliest: the lower end of the 90 % interval."""
    high: float | None


def trend_of(days: Sequence[SDay]) -> Trend | None:
    """Return the trend of S; None where too few days show it.

    Args:
        days: In order of time.
    """
    if len(days) < FEWEST:
        return None
    times = [each.time / DAY for each in days]
    known = [each.s for each in days if each.above is None] or [each.bound for each in days]
    middle = max(float(np.median(known)), 1e-9)
    followed = follow(times, _kinds(days, LEAST * middle), math.log(middle))
    jumps: list[Jump] = []
    levels: list[Level] = []
    first = 0
    for k, (start, state) in enumerate(followed):
        if start != first:
            first = start
            end = next((j for j in range(k, len(days)) if followed[j].first != first), len(days))
            after = math.exp(float(followed[end - 1].state.mean[0]))
            jumps.append(Jump(days[k].time, levels[-1].s, after))
        s, low, high = (math.exp(each) for each in _interval(state, 0))
        only_bounds = all(
            each.above is not None and each.divided(recognised=True)[1] <= 0 for each in days[first : k + 1]
        )
        levels.append(Level(days[k].time, s, 0.0 if only_bounds else low, high))
    last = followed[-1].state
    slope, low, high = (levels[-1].s * each for each in _interval(last, 1))
    worse_since = days[first].time if low > 0 else None
    return Trend(tuple(levels), tuple(jumps), slope, low, high, worse_since, last)


def reaches(trend: Trend, limit: float) -> Reached:
    """Return when S reaches ``limit`` (OP units) if it goes on as since the last jump."""
    times = [_first_beyond(trend, limit, z) for z in (0.0, NORMAL_90, -NORMAL_90)]
    return Reached(limit, *times)


def _first_beyond(trend: Trend, limit: float, z: float) -> float | None:
    """Return the first time, to the day, at which S plus ``z`` standard deviations is at the limit, s UTC."""

    def beyond(days: float) -> bool:
        ahead = forecast(trend.last, WALK, trend.last.time + days)
        return bool(ahead.mean[0] + z * math.sqrt(ahead.covariance[0, 0]) >= math.log(max(limit, 1e-9)))

    if beyond(0.0):
        return trend.last.time * DAY
    tried = np.concatenate((np.arange(1.0, 400.0), np.arange(400.0, FAR, 10.0)))
    return next(((trend.last.time + days) * DAY for days in tried.tolist() if beyond(days)), None)


def _kinds(days: Sequence[SDay], least: float) -> list[Kind]:
    """Return the kinds of valve that days distinguish: it is recognised by its former S, or it is not.

    One that is not is called repaired by each comparison, whatever its S: so they say nothing of S.
    """
    if all(each.agrees is None for each in days):
        return [Kind(1.0, [_seen(each, least, recognised=False) for each in days])]
    return [
        Kind(share, [_seen(each, least, recognised=recognised) for each in days])
        for recognised, share in ((True, 1 - UNRECOGNISED), (False, UNRECOGNISED))
    ]


def _seen(day: SDay, least: float, *, recognised: bool) -> SeenLevel:
    """Return what a day shows of log S: a lognormal distribution with mean and deviation of its S.

    What divides S is as soft as a short S.
    """
    if day.above is not None:
        divides, above = day.divided(recognised=recognised)
        return SeenLevel(math.log(max(divides, least)), LACKS, above)
    s, agrees = max(day.s, least), day.agrees or 0.0
    return SeenLevel(math.log(s), math.sqrt(math.log1p((day.sd / s) ** 2)), None, agrees * recognised)


def _interval(state: Filtered, place: int) -> tuple[float, float, float]:
    """Return the level (0) or the slope (1) with its 90 % interval."""
    mean, sd = float(state.mean[place]), math.sqrt(max(float(state.covariance[place, place]), 0.0))
    return mean, mean - NORMAL_90 * sd, mean + NORMAL_90 * sd
