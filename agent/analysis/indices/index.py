"""What every performance index is."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from agent.analysis.record.recording import LoopWindow

HOUR = 3600.0


class PerformanceIndex(Protocol):
    """A number that plants compute of a loop beside the verdict on its valve."""

    @property
    def name(self) -> str:
        """Stable key, also of the metric."""
        ...

    @property
    def unit(self) -> str:
        """Unit of the value; empty for a ratio."""
        ...

    @property
    def meaning(self) -> str:
        """One sentence for a reader of the report."""
        ...

    def of(self, window: LoopWindow, delay: float | None) -> float | None:
        """Return the index of a window; None where the window does not determine it.

        Args:
            window: The record.
            delay: Dead time of the process, s; None where it is not known.
        """
        ...
