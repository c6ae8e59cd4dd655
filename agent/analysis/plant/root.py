"""Where the oscillation of a group begins, and the way it takes.

Two clues of a root: its past says more of the future of the others than theirs of its own (``drives``); and
its wave is less like a sine, as each process on the way takes harmonics away (the loop with the largest
nonlinearity is the source: Thornhill, IEEE Trans. Control Systems Technology 13 (2005) 434). They are weighed
in the conditional logit of a choice of one out of a group (McFadden 1974), fitted to 26 groups of simulated
plants (`benchmarks/plant_wide.py`, seeds 0 to 13): the first alone is right for 23, the second for 7. The
part of a signal's power that the oscillation is, and the phase of its wave, added nothing. The diagnosis
of a loop, where there is one, comes on top with its own odds that the valve sticks.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.plant.drives import drives
from agent.analysis.plant.groups import in_step
from agent.analysis.plant.wave import CommonRecord, Wave, phasor, share_of

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from agent.analysis.record.recording import FloatArray

WEIGHTS = {"harmonics": 0.4, "drives": 2.0}
"""Of the logarithm of the odds, for each clue; fitted to simulated plants (`benchmarks/plant_wide.py`)."""
MOST_HARMONIC = 5
SMALLEST = 1e-300
LEAST_HARMONIC = 1e-3
"""Power of harmonics over that of the wave, below which there is none to compare."""


@dataclass(frozen=True, slots=True)
class Suspect:
    """A loop of a group."""

    loop: str
    wave: Wave
    probability: float
    """That the oscillation begins here, among the loops of the group."""
    clues: Mapping[str, float]
    """Clue -> value, compared with the mean of the group: positive speaks for a root."""


def suspects(
    record: CommonRecord, group: Sequence[Wave], odds: Mapping[str, float] | None = None
) -> list[Suspect]:
    """Return the loops of a group, the likeliest root first.

    Args:
        record: Of the plant.
        group: Its waves.
        odds: Loop -> natural logarithm of the odds that it makes an oscillation by itself, from its own
            diagnosis, over those of any loop; loops without are left as they are.
    """
    table = clues(record, group)
    score = sum(WEIGHTS[name] * values for name, values in table.items())
    score = score + np.array([(odds or {}).get(record.loops[each.place], 0.0) for each in group])
    weight = np.exp(score - np.max(score))
    found = [
        Suspect(
            record.loops[wave.place],
            wave,
            float(weight[k] / weight.sum()),
            {name: float(values[k]) for name, values in table.items()},
        )
        for k, wave in enumerate(group)
    ]
    return sorted(found, key=lambda each: -each.probability)


def clues(record: CommonRecord, group: Sequence[Wave]) -> dict[str, FloatArray]:
    """Return clue -> its value for each wave of a group, less their mean, (waves,)."""
    period = float(np.median([each.period for each in group]))
    samples = period / record.ts
    places = [each.place for each in group]
    plain = [share_of(record.errors[place], samples) for place in places]
    phase = np.unwrap(np.angle(phasor(record.errors[places[int(np.argmax(plain))]], samples)))
    table = {
        "harmonics": _harmonics(record, places, samples, phase),
        "drives": drives([record.errors[place] for place in places], samples),
    }
    return {name: values - np.mean(values) for name, values in table.items()}


def path(record: CommonRecord, group: Sequence[Wave], root: str) -> list[tuple[str, str]]:
    """Return the likeliest way from the root: pairs (from, to), in the order in which loops are reached.

    Each loop hangs on the one it is most in step with, of those reached before (Prim's tree).
    """
    period = float(np.median([each.period for each in group]))
    places = {record.loops[each.place]: each.place for each in group}
    reached, pairs = [root], []
    while len(reached) < len(places):
        step, one, other = max(
            (abs(in_step(record, places[a], places[b], period)), a, b)
            for a in reached
            for b in places
            if b not in reached
        )
        if step <= 0:
            break
        reached.append(other)
        pairs.append((one, other))
    return pairs


def _harmonics(record: CommonRecord, places: Sequence[int], samples: float, phase: FloatArray) -> FloatArray:
    """Return the logarithm of the power of harmonics over that of the wave, for each loop, (places,).

    Harmonics are what keeps step with twice to five times the phase of the plainest wave of the group; what
    keeps step with odd multiples of its half is noise, and is taken off.
    """
    edge = (len(record.errors[0]) - len(phase)) // 2
    most = max(min(MOST_HARMONIC, int(samples / 2)), 1)  # faster ones are past the Nyquist frequency
    found = []
    for place in places:
        values = record.errors[place][edge : edge + len(phase)]
        power = np.abs(np.exp(-0.5j * np.outer(np.arange(2, 2 * most + 2), phase)) @ values) ** 2
        first, higher, noise = power[0], power[2::2], power[1::2]
        harmonics = max(float(higher.sum() - noise[: len(higher)].sum()), 0.0)
        found.append(math.log(LEAST_HARMONIC + harmonics / max(float(first), SMALLEST)))
    return np.array(found)
