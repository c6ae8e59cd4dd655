"""Which oscillations of a plant are one: the same period, and in step over the whole record.

Periods alone are not enough: two valves may stick with periods that hardly differ for some cycles. So both
signals are filtered around the period, and their waves must keep their phase to each other; independent
ones drift apart. What one loop shows plainly is sought in all others, also where it hides in their noise.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.plant.wave import CommonRecord, Wave, belongs, phasor, share_of

if TYPE_CHECKING:
    from collections.abc import Sequence

APART = 0.12
"""Periods that differ by more, as logarithms, are of two oscillations: a peak is known to some percent."""
IN_STEP = 0.6
"""Least correlation of two waves around their period. Of simulated plants (seeds 0 to 13) loops of one root
have 0.85 and more where they oscillate visibly, loops of different ones at most 0.4."""
LEAST_SHARE = 0.02
"""Part of a loop's power below which it is no member, however well in step."""


def in_step(record: CommonRecord, one: int, other: int, period: float) -> complex:
    """Return the correlation of two loops around a period (s); its angle is how far the first is ahead."""
    first, second = (phasor(record.errors[place], period / record.ts) for place in (one, other))
    return complex(np.mean(first * second.conj()))


def groups(record: CommonRecord, found: Sequence[Wave]) -> list[list[Wave]]:
    """Return the oscillations that are one, at least two loops each, those that begin most plainly first.

    A group at a whole fraction of the period of another, in loops of that, is its harmonic and left out.
    """
    rest = sorted(found, key=lambda each: -each.share)
    made: list[list[Wave]] = []
    while rest:
        plain = rest[0]
        members = [plain]
        for place in range(len(record.loops)):
            member = _member(record, plain, place, rest)
            if place != plain.place and member is not None:
                members.append(member)
        rest = [each for each in rest if each not in members]
        if len(members) > 1 and not any(_harmonic(members, other) for other in made):
            made.append(members)
    return made


def _member(record: CommonRecord, plain: Wave, place: int, rest: Sequence[Wave]) -> Wave | None:
    """Return the wave of a loop that is in step with the plain one, None where it has none."""
    own = [each for each in rest if each.place == place and _near(each.period, plain.period)]
    wave = max(own, key=lambda each: each.share, default=None)
    if abs(in_step(record, plain.place, place, plain.period)) < IN_STEP:
        return None
    if wave is not None:
        return wave
    share = share_of(record.errors[place], plain.period / record.ts)
    return Wave(place, plain.period, share) if share >= LEAST_SHARE else None


def _near(one: float, other: float) -> bool:
    return bool(abs(np.log(one / other)) < APART)


def _harmonic(members: Sequence[Wave], stronger: Sequence[Wave]) -> bool:
    shared = {each.place for each in members} & {each.place for each in stronger}
    return len(shared) > 1 and belongs(members[0].period, stronger[0].period)
