"""S of a valve against time: where it jumped, how it rises, when it reaches a limit.

Stretches without a jump, each a local linear trend of the logarithm of S: wear and repair multiply S, and so
do errors of a window. A repair is a jump down. See docs/methods/wear.md.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.wear.filter import SeenLevel, forecast
from agent.analysis.wear.mixture import Normal, below, quantile
from agent.analysis.wear.stretches import UNRECOGNISED, WALK, Kind, follow

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agent.analysis.memory.s_day import SDay
    from agent.analysis.wear.stretches import LikelyStretch

DAY = 86400.0
"""s"""
ENDS = (0.05, 0.95)
"""Probabilities of being below the ends of a 90 % interval."""
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
    last: tuple[LikelyStretch, ...]
    """What S may be on the last day."""

    @property
    def repaired(self) -> float | None:
        """Time of the last repair, s UTC; None: there was none."""
        return _last_repair(self.jumps)


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
    followed = _followed(days)
    levels = _levels(days, followed)
    stretches = _stretches(followed)
    newest = followed[-1]
    slopes = [Normal(each.share, each.state.slope, each.state.slope_var) for each in newest]
    slope, low, high = (levels[-1].s * quantile(slopes, each) for each in (0.5, *ENDS))
    worse_since = days[stretches[-1][0]].time if low > 0 else None
    return Trend(levels, _jumps(days, followed, stretches), slope, low, high, worse_since, tuple(newest))


def repaired_of(days: Sequence[SDay]) -> float | None:
    """Return the time of the last repair, s UTC; None: there was none. As ``trend_of``, in less time."""
    if len(days) < FEWEST:
        return None
    followed = _followed(days)
    return _last_repair(_jumps(days, followed, _stretches(followed)))


def _followed(days: Sequence[SDay]) -> list[list[LikelyStretch]]:
    """Return what S may be on each day, by the days up to it."""
    known = [each.s for each in days if each.above is None] or [each.bound for each in days]
    middle = max(float(np.median(known)), 1e-9)
    return follow([each.time / DAY for each in days], _kinds(days, LEAST * middle), math.log(middle))


def _levels(days: Sequence[SDay], followed: Sequence[Sequence[LikelyStretch]]) -> tuple[Level, ...]:
    """Return S on each day with its interval: quantiles of the mixture."""
    levels, shown = [], -1
    for k, (day, parts) in enumerate(zip(days, followed, strict=True)):
        if day.above is None or any(above > 0 for _, above in day.divided(recognised=True)):
            shown = k
        found = (quantile(_log_s(parts), 0.5), quantile(_log_s(parts, shown), ENDS[0]))
        levels.append(Level(day.time, *map(math.exp, (*found, quantile(_log_s(parts), ENDS[1])))))
    return tuple(levels)


def _stretches(followed: Sequence[Sequence[LikelyStretch]]) -> list[tuple[int, int]]:
    """Return the first and last day of each stretch: the begin is the median of what it may be."""
    found, last = [], len(followed) - 1
    while last >= 0:
        first, earlier = 0, 0.0
        for part in sorted(followed[last], key=_first):
            if earlier < 0.5:
                first = part.first
            earlier += part.share
        found.append((first, last))
        last = first - 1
    return found[::-1]


def _jumps(
    days: Sequence[SDay], followed: Sequence[Sequence[LikelyStretch]], stretches: Sequence[tuple[int, int]]
) -> tuple[Jump, ...]:
    """Return the jumps between stretches: S as it was known before, and at the end of the stretch."""
    found = []
    for first, last in stretches[1:]:
        ones = [each for each in followed[last] if each.first == first]
        share = sum(each.share for each in ones)
        after = sum(each.share * each.state.level for each in ones) / share
        before = quantile(_log_s(followed[first - 1]), 0.5)
        found.append(Jump(days[first].time, math.exp(before), math.exp(after)))
    return tuple(found)


def _last_repair(jumps: Sequence[Jump]) -> float | None:
    return next((each.time for each in reversed(jumps) if each.repair), None)


def _log_s(parts: Sequence[LikelyStretch], shown: float = math.inf) -> list[Normal]:
    """Return what log S may be; in a stretch without a day that ``shown`` S also anything below."""
    return [
        Normal(each.share, -math.inf if each.first > shown else each.state.level, each.state.level_var)
        for each in parts
    ]


def _first(part: LikelyStretch) -> int:
    return part.first


def reaches(trend: Trend, limit: float) -> Reached:
    """Return when S reaches ``limit`` (OP units) if it goes on as since the last jump."""
    times = [_first_beyond(trend, limit, each) for each in (0.5, *reversed(ENDS))]
    return Reached(limit, *times)


def _first_beyond(trend: Trend, limit: float, probability: float) -> float | None:
    """Return the first time, to the day, at which S is below the limit with no more than this probability."""
    now, end = trend.last[0].state.time, math.log(max(limit, 1e-9))

    def beyond(days: float) -> bool:
        ahead = [(each.share, forecast(each.state, WALK, now + days)) for each in trend.last]
        parts = [Normal(share, state.level, state.level_var) for share, state in ahead]
        return below(parts, end) <= probability

    tried = np.concatenate((np.arange(0.0, 400.0), np.arange(400.0, FAR, 10.0)))
    return next(((now + days) * DAY for days in tried.tolist() if beyond(days)), None)


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
    """Return what a day shows of log S: a lognormal distribution with mean and deviation of its S."""
    if day.above is not None:
        divides = day.divided(recognised=recognised)
        return SeenLevel(0.0, 0.0, tuple((math.log(max(each, least)), above) for each, above in divides))
    s, agrees = max(day.s, least), day.agrees or 0.0
    return SeenLevel(math.log(s), math.sqrt(math.log1p((day.sd / s) ** 2)), agrees=agrees * recognised)
