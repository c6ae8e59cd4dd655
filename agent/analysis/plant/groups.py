"""Which oscillations of a plant are one: the same period, and in step over the whole record.

Periods alone are not enough: two valves may stick with periods that nobody can tell apart for some cycles. So
both signals are filtered around the period, and their waves must keep their phase to each other; independent
ones drift apart. The bound is the correlation that independent waves of that regularity hardly reach.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.plant.wave import CommonRecord, Wave, phasor

if TYPE_CHECKING:
    from collections.abc import Sequence

APART = 0.12
"""Periods that differ by more, as logarithms, are of two oscillations: a peak is known to some percent."""
IN_STEP = 0.6
"""Least correlation of two waves around their period; found on simulated plants (seeds 0 to 13)."""


def in_step(record: CommonRecord, one: Wave, other: Wave) -> complex:
    """Return the correlation of two waves at their mean period; its angle is how far the first is ahead."""
    period = float(np.sqrt(one.period * other.period)) / record.ts
    first, second = (phasor(record.errors[each.place], period) for each in (one, other))
    return complex(np.mean(first * second.conj()))


def groups(record: CommonRecord, found: Sequence[Wave]) -> list[list[Wave]]:
    """Return the oscillations that are one, at least two loops each, those of the most loops first."""
    group = list(range(len(found)))
    for k, one in enumerate(found):
        for j in range(k):
            other = found[j]
            near = abs(np.log(one.period / other.period)) < APART
            if group[k] != group[j] and one.place != other.place and near:
                if abs(in_step(record, one, other)) >= IN_STEP:
                    old, new = group[k], group[j]
                    group = [new if each == old else each for each in group]
    joined = [[wave for wave, its in zip(found, group, strict=True) if its == k] for k in set(group)]
    single = [_one_a_loop(each) for each in joined]
    return sorted((each for each in single if len(each) > 1), key=lambda each: -len(each))


def _one_a_loop(group: Sequence[Wave]) -> list[Wave]:
    """Keep the largest wave of each loop."""
    kept: dict[int, Wave] = {}
    for each in sorted(group, key=lambda wave: -wave.share):
        kept.setdefault(each.place, each)
    return list(kept.values())
