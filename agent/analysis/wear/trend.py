"""S of a valve against time: where it jumped, how it rises, when it reaches a limit.

The most likely partition of the days into stretches without a jump (dynamic programming over all partitions),
each a local linear trend. A repair is a jump down. See docs/methods/wear.md.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.results import NORMAL_90
from agent.analysis.wear.filter import Filtered, LevelWalk, begin, forecast, step

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agent.analysis.memory.s_day import SDay

DAY = 86400.0
"""s"""
FEWEST = 3
"""Days below which there is no trend."""
JUMPS_A_DAY = 1 / 365
"""Rate of repairs and sudden damages: one a year."""
WALK = 0.01
"""Standard deviation of the walk of S in a day, over its middle: 8 % in two months."""
SLOPE = 0.05
"""Standard deviation of the slope before anything is seen, a day, over the middle of S: weeks double it."""
LEAST_SD = 0.05
"""Smallest standard deviation of a day, over the middle of S: what models lack is in all of its windows."""
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
    """OP units, with a 90 % interval."""


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
    """Of S since the last jump, OP units a day, with a 90 % interval."""
    worse_since: float | None
    """Time from which S rises, s UTC; None: it does not rise for certain."""
    last: Filtered
    walk: LevelWalk

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
    times = np.array([each.time for each in days]) / DAY
    values = np.array([each.s for each in days])
    middle = max(float(np.median(values)), 1e-9)
    top = float(values.max())
    sds = np.hypot([each.sd for each in days], LEAST_SD * middle)
    walk = LevelWalk(WALK * middle, SLOPE * middle, max(top, middle), middle)
    starts = _starts(times, values, sds, walk)
    levels: list[Level] = []
    jumps: list[Jump] = []
    state = begin(walk, float(times[0]))
    for k in range(len(days)):
        before = float(state.mean[0])
        if k in starts:
            state = begin(walk, float(times[k]))
        state = step(state, walk, float(times[k]), float(values[k]), float(sds[k]))
        if k in starts and k:
            end = next((each for each in starts if each > k), len(days))
            jumps.append(Jump(days[k].time, before, float(np.median(values[k:end]))))
        sd = math.sqrt(max(float(state.covariance[0, 0]), 0.0))
        s = float(state.mean[0])
        levels.append(
            Level(days[k].time, max(s, 0.0), max(s - NORMAL_90 * sd, 0.0), max(s + NORMAL_90 * sd, 0.0))
        )
    slope, sd = float(state.mean[1]), math.sqrt(max(float(state.covariance[1, 1]), 0.0))
    rises = slope - NORMAL_90 * sd > 0
    return Trend(
        tuple(levels),
        tuple(jumps),
        slope,
        slope - NORMAL_90 * sd,
        slope + NORMAL_90 * sd,
        days[max(starts)].time if rises else None,
        state,
        walk,
    )


def reaches(trend: Trend, limit: float) -> Reached:
    """Return when S reaches ``limit`` (OP units) if it goes on as since the last jump."""
    times = [_first_beyond(trend, limit, z) for z in (0.0, NORMAL_90, -NORMAL_90)]
    return Reached(limit, *times)


def _first_beyond(trend: Trend, limit: float, z: float) -> float | None:
    """Return the first time, to the day, at which S plus ``z`` standard deviations is at the limit, s UTC."""

    def beyond(days: float) -> bool:
        ahead = forecast(trend.last, trend.walk, trend.last.time + days)
        return bool(ahead.mean[0] + z * math.sqrt(max(float(ahead.covariance[0, 0]), 0.0)) >= limit)

    if beyond(0.0):
        return trend.last.time * DAY
    tried = np.concatenate((np.arange(1.0, 400.0), np.arange(400.0, FAR, 10.0)))
    return next(((trend.last.time + days) * DAY for days in tried.tolist() if beyond(days)), None)


def _starts(times: np.ndarray, values: np.ndarray, sds: np.ndarray, walk: LevelWalk) -> tuple[int, ...]:
    """Return the first day of each stretch of the most likely partition, 0 first."""
    count = len(times)
    best = np.full(count + 1, -math.inf)
    best[0] = 0.0
    origin = [0] * (count + 1)
    for first in range(count):
        days = times[first] - times[first - 1] if first else 0.0
        jumped = math.log(-math.expm1(-JUMPS_A_DAY * max(days, 1.0))) if first else 0.0
        state = begin(walk, float(times[first]))
        for last in range(first, count):
            state = step(state, walk, float(times[last]), float(values[last]), float(sds[last]))
            score = best[first] + jumped + state.log_likelihood
            if score > best[last + 1]:
                best[last + 1], origin[last + 1] = score, first
    starts, end = [], count
    while end > 0:
        starts.append(origin[end])
        end = origin[end]
    return tuple(reversed(starts))
