"""Days cut into stretches without a jump, for each kind of valve that it may be.

The most likely partition (dynamic programming over all of them) for each kind; how probable a kind is follows
from the days so far: a random effect a valve, which no number of windows averages away. There are valves
whose windows are right and valves where S is short, and either may be recognised by its former S or not.

Source: B. Jackson et al., "An algorithm for optimal partitioning of data on an interval", IEEE Signal
Processing Letters 12, 2005.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from agent.analysis.wear.filter import Filtered, LevelWalk, SeenLevel, begin, mixed, step

if TYPE_CHECKING:
    from collections.abc import Sequence

JUMPS_A_DAY = 1 / 365
"""Rate of repairs and sudden damages: one a year."""
WALK = 0.01
"""Standard deviation of the walk of log S in a day: 8 % in two months."""
SLOPE = 0.05
"""Standard deviation of the slope of log S before anything is seen, a day: weeks double S."""
SPREAD = 1.5
"""Standard deviation of log S before anything is seen, and after a jump."""
FALLS = 1.5
"""By how much log S fell at a jump, in the mean, as most are repairs: to a fifth, so that a twentieth is as
probable as hardly less."""
SHORT_VALVES = 0.388
"""Share of the valves whose windows are short, before any is seen."""
LACKS = 0.083
"""Mean of what S of their windows lacks, and the standard deviation of that, logarithm of S. Both are the
likeliest values for simulated valves (``python -m benchmarks s_errors``)."""
UNRECOGNISED = 0.15
"""Share of the valves, before any is seen, that a comparison with their former S calls repaired in each
window, also while they stick."""


class Kind(NamedTuple):
    """A kind of valve."""

    share: float
    """Of the valves, before any day is seen."""
    seen: Sequence[SeenLevel]
    """What each day shows in it."""


class Followed(NamedTuple):
    """The level on a day."""

    first: int
    """First day of its stretch, in the likelier kind of valve."""
    state: Filtered
    """From the days up to it, all kinds of valve mixed."""


class _Day(NamedTuple):
    """A day of the most likely partition into stretches."""

    first: int
    """First day of its stretch."""
    state: Filtered
    score: float
    """Log probability of the kind of valve and all days so far, nats."""


def follow(times: Sequence[float], kinds: Sequence[Kind], middle: float) -> list[Followed]:
    """Return the level on each day.

    Args:
        times: Of the days, days, in order.
        kinds: Kinds of valve that it may be, beside whether S of its windows is short.
        middle: Of log S, where nothing else is known.
    """
    found = [
        _likeliest(times, kind.seen, LevelWalk(WALK, SLOPE, SPREAD, middle, lacks), share * kind.share)
        for kind in kinds
        for lacks, share in ((0.0, 1 - SHORT_VALVES), (LACKS, SHORT_VALVES))
    ]
    likeliest = max(found, key=lambda days: days[-1].score)
    states = [mixed(_shares(day), [each.state for each in day]) for day in zip(*found, strict=True)]
    return [Followed(day.first, state) for day, state in zip(likeliest, states, strict=True)]


def _shares(kinds: Sequence[_Day]) -> list[float]:
    """Return how probable each kind of valve is by a day."""
    top = max(each.score for each in kinds)
    weights = [math.exp(each.score - top) for each in kinds]
    return [each / sum(weights) for each in weights]


def _likeliest(
    times: Sequence[float], seen: Sequence[SeenLevel], walk: LevelWalk, share: float
) -> list[_Day]:
    """Return the days in the most likely partition; ``share`` of the valves are of this kind."""
    count = len(times)
    best: list[list[_Day]] = [[] for _ in range(count + 1)]
    for first in range(count):
        days = times[first] - times[first - 1] if first else 0.0
        jumped = math.log(-math.expm1(-JUMPS_A_DAY * max(days, 1.0))) if first else 0.0
        before = jumped + (best[first][-1].score if first else math.log(share))
        state, stretch = begin(walk, times[first], FALLS if first else 0.0), best[first]
        for last in range(first, count):
            state = step(state, walk, times[last], seen[last])
            stretch = [*stretch, _Day(first, state, before + state.log_likelihood)]
            if not best[last + 1] or stretch[-1].score > best[last + 1][-1].score:
                best[last + 1] = stretch
    return best[count]
