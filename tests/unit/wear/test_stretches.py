"""What S may be by a day is the sum over all partitions of the days into stretches, each written out."""

import math
from itertools import product

import pytest

from agent.analysis.wear.filter import LevelWalk, SeenLevel, begin, of_valve, step
from agent.analysis.wear.stretches import (
    FALLS,
    JUMPS_A_DAY,
    SCATTERS,
    SLOPES,
    SPREAD,
    WALK,
    Kind,
    follow,
)

TIMES = [0.0, 1.0, 2.5, 3.0, 6.0]
SHOWN = [
    SeenLevel(1.4, 0.1),
    SeenLevel(1.3, 0.1),
    SeenLevel(1.5, 0.2),
    SeenLevel(0.0, 0.0, ((0.7, -4.0), (1.0, -1.0))),
]
SEEN = [*SHOWN, SeenLevel(0.2, 0.4)]
KINDS = [Kind(0.8, SEEN), Kind(0.2, [*SEEN[:3], SeenLevel(0.0, 0.0, ((0.7, 0.0),)), SEEN[4]])]
MIDDLE = 1.4


def each_partition():
    """Yield first day of the last stretch, joint probability and mean level on the last day, of each kind."""
    for kind, (share, own), *jumps in product(KINDS, SCATTERS, *[(False, True)] * (len(TIMES) - 1)):
        firsts = [0, *(k + 1 for k, jump in enumerate(jumps) if jump)]
        for slopes in product(SLOPES, repeat=len(firsts)):
            walk = LevelWalk(WALK, SPREAD, MIDDLE, own)
            log, ends = math.log(share * kind.share), [*firsts[1:], len(TIMES)]
            for first, end, slope in zip(firsts, ends, slopes, strict=True):
                state = begin(walk, slope, TIMES[first], FALLS if first else 0.0)
                for k in range(first, end):
                    state = step(state, walk, TIMES[k], kind.seen[k])
                log += math.log(slope.share) + state.log_likelihood
                log -= JUMPS_A_DAY * (TIMES[end - 1] - TIMES[first])
                if first:
                    gap = max(TIMES[first] - TIMES[first - 1], 1.0)
                    log += math.log(-math.expm1(-JUMPS_A_DAY * gap))
            yield firsts[-1], math.exp(log), of_valve(state).level


def test_the_parts_of_the_last_day_are_the_sum_over_all_partitions():
    partitions = list(each_partition())
    total = sum(share for _, share, _ in partitions)
    parts = follow(TIMES, KINDS, MIDDLE)[-1]
    assert sum(each.share for each in parts) == pytest.approx(1.0)
    for first in range(len(TIMES)):
        expected = sum(share for at, share, _ in partitions if at == first) / total
        assert sum(each.share for each in parts if each.first == first) == pytest.approx(expected, abs=1e-3)
    level = sum(each.share * each.state.level for each in parts)
    expected = sum(share * mean for _, share, mean in partitions) / total
    assert level == pytest.approx(expected, abs=1e-3)
