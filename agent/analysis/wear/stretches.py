"""Days cut into stretches without a jump, for each kind of valve that it may be.

A day has its place in many partitions of the days up to it: its stretch began on any of them. How probable
each begin is follows from the sum over all partitions before it, so S is known as a mixture over begins. A
jump that may have come on several days is as probable as these together. A stretch is steady, or it wears.

There are random effects a valve, which no number of windows averages away. It is recognised by its former S
or it is not, and its windows scatter little or as far as their intervals say: how probable a kind is follows
from the days so far. And its windows are wrong in the same way (``filter``).

Source: D. Barry and J. A. Hartigan, "Product partition models for change point problems", Annals of
Statistics 20, 1992; R. P. Adams and D. J. C. MacKay, "Bayesian online changepoint detection", arXiv
0710.3742, 2007.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from agent.analysis.wear.filter import Filtered, LevelWalk, SeenLevel, Slope, begin, of_valve, step

if TYPE_CHECKING:
    from collections.abc import Sequence

JUMPS_A_DAY = 1 / 365
"""Rate of repairs and sudden damages: one a year."""
WALK = 0.01
"""Standard deviation of the walk of log S in a day: 8 % in two months."""
SLOPES = (Slope(0.5, 0.0, 0.003), Slope(0.5, 0.04, 0.025))
"""Slope of log S: one stretch in two is steady, by a tenth in a month; the other wears, and weeks double S. S
falls by repair alone, so a level that is not seen for days does not sink into what contradicts it."""
SPREAD = 1.5
"""Standard deviation of log S before anything is seen, and after a jump."""
FALLS = 1.5
"""By how much log S fell at a jump, in the mean, as most are repairs: to a fifth, so that a twentieth is as
probable as hardly less."""
SCATTERS = ((0.69, 0.35), (0.31, 1.01))
"""Share of the valves, and standard deviation of what log S of each window has for itself there, over that of
its interval: in most valves windows agree far better than their intervals say, in others as they say. The
likeliest values for simulated valves (``python -m benchmarks s_errors``)."""
UNRECOGNISED = 0.15
"""Share of the valves, before any is seen, that a comparison with their former S calls repaired in each
window, also while they stick."""
LEAST_LIKELY = -9.0
"""Log of the share, over that of the likeliest part of a day, below which a part is left out."""


class Kind(NamedTuple):
    """A kind of valve."""

    share: float
    """Of the valves, before any day is seen."""
    seen: Sequence[SeenLevel]
    """What each day shows in it."""


class LikelyStretch(NamedTuple):
    """What S is on a day where it is a valve of one kind, and its stretch began on one day."""

    share: float
    """How probable that is by the days up to it; all parts of a day add up to one."""
    first: int
    """First day of the stretch."""
    state: Filtered


class _Running(NamedTuple):
    """A stretch that goes on."""

    start: float
    """Log probability of all that was before it, and of its begin, nats."""
    first: int
    state: Filtered

    @property
    def weight(self) -> float:
        """Log probability of it and all days so far, nats."""
        return self.start + self.state.log_likelihood


def follow(times: Sequence[float], kinds: Sequence[Kind], middle: float) -> list[list[LikelyStretch]]:
    """Return what S may be on each day, by the days up to it.

    Args:
        times: Of the days, days, in order.
        kinds: Kinds of valve that it may be, beside how far its windows scatter.
        middle: Of log S, where nothing else is known.
    """
    valves = [
        (kind.seen, LevelWalk(WALK, SPREAD, middle, own), math.log(share * kind.share))
        for kind in kinds
        for share, own in SCATTERS
    ]
    running: list[list[_Running]] = [[] for _ in valves]
    found = []
    for k, time in enumerate(times):
        gap = time - times[k - 1] if k else 0.0
        running = [
            _next_day(before, walk, k, time, gap, seen[k], share)
            for before, (seen, walk, share) in zip(running, valves, strict=True)
        ]
        top = max(each.weight for some in running for each in some)
        running = [[each for each in some if each.weight > top + LEAST_LIKELY] for some in running]
        found.append(_parts([each for some in running for each in some], top))
    return found


def _next_day(
    before: Sequence[_Running],
    walk: LevelWalk,
    k: int,
    time: float,
    gap: float,
    seen: SeenLevel,
    share: float,
) -> list[_Running]:
    """Return the stretches of a kind of valve after one more day, the ``k``-th, ``gap`` days after the last.

    ``share`` is the log probability of the kind.
    """
    went_on = [each._replace(start=each.start - JUMPS_A_DAY * gap) for each in before]
    if k and before:
        share = _log_sum([each.weight for each in before])
        share += math.log(-math.expm1(-JUMPS_A_DAY * max(gap, 1.0)))
    begun = [
        _Running(share + math.log(each.share), k, begin(walk, each, time, FALLS if k else 0.0))
        for each in SLOPES
        if before or not k
    ]
    return [each._replace(state=step(each.state, walk, time, seen)) for each in (*went_on, *begun)]


def _parts(running: Sequence[_Running], top: float) -> list[LikelyStretch]:
    """Return the stretches with their probabilities; ``top`` is the log weight of the likeliest."""
    weights = [math.exp(each.weight - top) for each in running]
    total = sum(weights)
    return [
        LikelyStretch(weight / total, each.first, of_valve(each.state))
        for each, weight in zip(running, weights, strict=True)
    ]


def _log_sum(logs: Sequence[float]) -> float:
    top = max(logs)
    return top + math.log(sum(math.exp(each - top) for each in logs))
