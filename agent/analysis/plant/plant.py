"""A plant as a whole: groups of loops that oscillate together, each with its likeliest root and path."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.plant.groups import groups
from agent.analysis.plant.root import Suspect, path, suspects
from agent.analysis.plant.wave import FEWEST_SAMPLES, common_record, waves

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agent.analysis.diagnosis import Diagnosis
    from agent.analysis.record.recording import LoopWindow

TOO_TIGHT = 1.0
"""Logarithm of the odds of a loop whose own oscillation its tuning explains."""
SURE = 0.999
"""Probability of one diagnosis beyond which it counts as this: it does not know of the other loops."""


@dataclass(frozen=True, slots=True)
class PlantGroup:
    """Loops with one oscillation."""

    period: float
    """s."""
    suspects: tuple[Suspect, ...]
    """All loops of the group, the likeliest root first."""
    path: tuple[tuple[str, str], ...]
    """(from, to): the likeliest way of the oscillation from the root, in the order of its spread."""

    @property
    def root(self) -> str:
        """The loop where it begins most probably."""
        return self.suspects[0].loop


@dataclass(frozen=True, slots=True)
class PlantFinding:
    """What loops of one plant say together."""

    groups: tuple[PlantGroup, ...]
    """Those of the largest oscillations first."""
    compared: tuple[str, ...]
    """Loops that share enough time to be compared."""
    seconds: float
    """Time that they share, s."""


def plant_finding(windows: Sequence[LoopWindow], diagnoses: Sequence[Diagnosis] = ()) -> PlantFinding:
    """Find the groups of a plant, and where each begins.

    Args:
        windows: One of each loop; names differ.
        diagnoses: Of any of them; a loop without one is judged by its wave alone.
    """
    if not windows:
        return PlantFinding((), (), 0.0)
    record = common_record(windows)
    if len(record.loops) < 2 or len(record.errors[0]) < FEWEST_SAMPLES:
        return PlantFinding((), record.loops, 0.0)
    odds = {each.loop: _odds(each) for each in diagnoses}
    found = []
    for group in groups(record, waves(record)):
        likely = suspects(record, group, odds)
        period = float(np.median([each.period for each in group]))
        found.append(PlantGroup(period, tuple(likely), tuple(path(record, group, likely[0].loop))))
    return PlantFinding(tuple(found), record.loops, len(record.errors[0]) * record.ts)


def _odds(diagnosis: Diagnosis) -> float:
    """Return by how much a diagnosis changes the odds of a loop: of its valve, or of its tuning."""
    if diagnosis.verdict == "no_stiction" and diagnosis.cause == "tight_tuning":
        return TOO_TIGHT
    sticks = diagnosis.sticks
    if sticks is None:
        return 0.0
    p = min(max(sticks.probability, 1 - SURE), SURE)
    return math.log(p / (1 - p)) - math.log(sticks.base_rate / (1 - sticks.base_rate))
