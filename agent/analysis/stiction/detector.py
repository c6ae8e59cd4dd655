"""The interface of every stiction detector."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from agent.analysis.record.recording import LoopWindow
    from agent.analysis.results import MethodKind, MethodResult, Oscillation


class StictionDetector(Protocol):
    """Judges from the shape of the signals whether a valve sticks, without a model of the loop."""

    @property
    def name(self) -> str:
        """Short name: author, or author and kind."""
        ...

    @property
    def kind(self) -> MethodKind:
        """What it looks at; a gate closes it where the record does not show that."""
        ...

    def detect(self, window: LoopWindow, oscillation: Oscillation) -> MethodResult:
        """Judge one window whose oscillation is known; never raises on its content.

        A limit of the method that the window breaks gives ``not_applicable`` with the limit as reason.
        """
        ...
