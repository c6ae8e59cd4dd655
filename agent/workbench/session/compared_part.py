"""The part of a very long recording that is compared."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from agent.analysis.recording_stretches import liveliest_stretch, part_of

if TYPE_CHECKING:
    from collections.abc import Mapping

    from agent.analysis.record.recording import FloatArray, LoopWindow

LONGEST = 10_000
"""Samples that are compared at most, unless OP swings fewer than six times in them: ``--auto`` takes half a
minute on so many and four minutes on a day of seconds, in which a process is not the same all the time."""


@dataclass(frozen=True, slots=True)
class ComparedPart:
    """Which samples of a recording are compared."""

    where: slice
    samples: int
    """Of the whole recording."""
    ts: float
    """s."""

    @property
    def words(self) -> str:
        """What takes no part, in words."""
        begin, end = self.where.start * self.ts, self.where.stop * self.ts
        count = self.where.stop - self.where.start
        return (
            f"what happened before {begin:.6g} s and after {end:.6g} s of the recording: of {self.samples} "
            f"samples {count} are compared, those in which OP moves most"
        )


def compared_part(
    window: LoopWindow, inputs: Mapping[str, FloatArray]
) -> tuple[LoopWindow, Mapping[str, FloatArray], ComparedPart | None]:
    """Return the part of a recording in which OP moves most, its inputs, and which part it is; None: all.

    Args:
        window: The recording.
        inputs: Measured inputs, each (n,); one of another length is returned as it is.
    """
    where = liveliest_stretch(window, LONGEST)
    if where == slice(0, len(window)):
        return window, inputs, None
    cut = {name: each[where] if len(each) == len(window) else each for name, each in inputs.items()}
    return part_of(window, where), cut, ComparedPart(where, len(window), window.ts)
