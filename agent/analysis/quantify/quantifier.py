"""The interface of every quantifier."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from agent.analysis.record.recording import LoopWindow
    from agent.analysis.results import Quantification


class Quantifier(Protocol):
    """Estimates by how much the valve of a loop sticks. Picklable, since it runs in a process pool."""

    @property
    def name(self) -> str:
        """Short name, as on the command line."""
        ...

    def quantify(self, window: LoopWindow) -> Quantification:
        """Measure one window; never raises on its content."""
        ...
