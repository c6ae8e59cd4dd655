"""The interface of every oscillation detector."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from agent.analysis.record.recording import LoopWindow
    from agent.analysis.results import Oscillation


class OscillationDetector(Protocol):
    """Detects whether a loop oscillates, how fast and how regularly."""

    @property
    def name(self) -> str:
        """Short name, as the literature calls it."""
        ...

    @property
    def noise_proof(self) -> bool:
        """Whether it finds an oscillation in at most one of twenty records of noise, whatever its colour."""
        ...

    def detect(self, window: LoopWindow) -> Oscillation:
        """Judge one window; never raises on its content."""
        ...
