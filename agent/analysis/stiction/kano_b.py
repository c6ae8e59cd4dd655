"""The sides of the parallelogram that a sticking valve draws over OP: their length is the stick band S.

Source: M. Kano, H. Maruta, H. Kugemoto and K. Shimizu, "Practical model and detection algorithm for valve
stiction", IFAC DYCOPS 2004, method B; reconstructed from reference ``methods.md`` 3.4.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.results import MethodKind, MethodResult, Oscillation
from agent.analysis.stiction.shapes.stem import stem_of
from agent.analysis.stiction.shapes.stuck import StuckIntervals, stuck_intervals

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray, LoopWindow

FEWEST = 3
"""Sides of the parallelogram each way."""
LEAST_SHARE = 0.5
"""Part of OP's strokes that have a side (ours): a free stem stands by chance now and then."""
LARGEST_SPREAD = 0.5
"""Standard deviation over mean of the sides, below which they are of one length."""
UNLIKE = 2.0
"""Ratio of the mean sides up and down, from which they do not agree (ours)."""


@dataclass(frozen=True, slots=True)
class Parallelogram:
    """What the detector measured; numbers of a side are 0 where there are fewer than three each way."""

    stuck: StuckIntervals
    strokes: int
    """How often OP crosses its mean."""
    sides: FloatArray
    """How far OP goes from where the stem stops to where it moves again, OP units, < 0 downward, (m,)."""
    s: float = 0.0
    """Mean length of a side: the stick band, OP units."""
    j: float = 0.0
    """Mean jump of the stem as it moves again: the slip jump, unit of the stem."""
    spread: float = 0.0
    """Standard deviation of the lengths over their mean."""
    unlikeness: float = 0.0
    """Mean length one way over that the other way, >= 1."""


@dataclass(frozen=True, slots=True)
class KanoB:
    """For loops with a measured valve position, and fast ones without."""

    name: str = "kano_b"
    kind: MethodKind = "travel"

    def detect(self, window: LoopWindow, oscillation: Oscillation) -> MethodResult:
        """Judge whether the sides are of one length; the index is S over the span of OP."""
        stem = stem_of(window, oscillation)
        stuck = stem if isinstance(stem, str) else stuck_intervals(stem)
        if isinstance(stuck, str):
            return MethodResult("not_applicable", None, stuck)
        seen = parallelogram(stuck)
        index = seen.s / float(np.ptp(stuck.stem.op))
        if seen.s == 0 or len(seen.sides) < LEAST_SHARE * seen.strokes:
            found = f"the stem stops in {len(seen.sides)} of the {seen.strokes} strokes of OP"
            return MethodResult("no_stiction" if stuck.stem.measured else "undecided", index, found, seen)
        found = f"OP travels {seen.s:.3g} OP units while the stem stops, with a spread of {seen.spread:.0%}"
        if seen.spread < LARGEST_SPREAD and seen.unlikeness < UNLIKE:
            return MethodResult("stiction", index, found, seen)
        return MethodResult("undecided", index, f"{found}: the stops differ too much", seen)


def parallelogram(stuck: StuckIntervals) -> Parallelogram:
    """Measure the sides of the parallelogram that the stem draws over OP."""
    op, position, half = stuck.stem.op, stuck.stem.position, stuck.stem.width // 2
    strokes = int(np.count_nonzero(np.diff(np.signbit(op - np.mean(op)))))
    # A stop that touches the end of the record is cut short.
    whole = [each for each in stuck.intervals if each.start > half and each.stop + 2 * half < len(op)]
    stops = np.array([each.start for each in whole], dtype=int)
    restarts = np.array([each.stop for each in whole], dtype=int)
    # A moving mean smears a jump over its width, half of it into the time in which the stem stands.
    sides = op[restarts + half] - op[stops - half]
    up, down = sides[sides > 0], -sides[sides < 0]
    if min(len(up), len(down)) < FEWEST:
        return Parallelogram(stuck, strokes, sides)
    lengths, each_way = np.abs(sides), sorted((float(np.mean(up)), float(np.mean(down))))
    return Parallelogram(
        stuck=stuck,
        strokes=strokes,
        sides=sides,
        s=float(np.mean(lengths)),
        j=float(np.mean(np.abs(position[restarts + 2 * half] - position[restarts - 1]))),
        spread=float(np.std(lengths) / np.mean(lengths)),
        unlikeness=each_way[1] / each_way[0],
    )
