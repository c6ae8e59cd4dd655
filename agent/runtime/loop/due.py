"""A window that is due or being judged, in half of its memory: a loop has two where workers are behind."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Self

from agent.runtime.loop.packed import Packed

if TYPE_CHECKING:
    from agent.analysis.record.recording import LoopWindow


@dataclass(frozen=True, slots=True)
class Due:
    """A window and since when it is due."""

    packed: Packed[LoopWindow]
    since: float
    """Monotonic, s."""
    start: float
    """Time of the first sample, s UTC."""
    last: float
    """Time of the last sample, s UTC."""
    end: float
    """One sampling time after the last sample, s UTC."""

    @classmethod
    def of(cls, window: LoopWindow, since: float) -> Self:
        """Take a window that is due since then (monotonic, s)."""
        last = float(window.time[-1])
        return cls(Packed.of(window), since, window.start, last, last + window.ts)
