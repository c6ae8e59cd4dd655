"""What a loop's pipeline says of each window, and who wants to know it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from agent.alarms import Announcement
    from agent.analysis.diagnosis import Diagnosis
    from agent.runtime.intake.cut import CutWindow


@dataclass(frozen=True, slots=True)
class Judged:
    """A window that was judged."""

    diagnosis: Diagnosis
    end: float
    """Of the window, s UTC."""
    took: float
    """Time from the window's end to its verdict, waiting for a worker included, s."""
    fitted: bool
    """Whether it got a full diagnosis, with a fit; else it was quiet or not testable."""
    cut: CutWindow
    """What was judged, opened by who needs it."""
    alarmed: bool = False
    """Whether the alarm was active before or after it."""


class Observer(Protocol):
    """Wants to know what becomes of loops; called in the event loop, so it must be quick."""

    def judged(self, judged: Judged) -> None:
        """Take the verdict on a window."""
        ...

    def announced(self, announcement: Announcement) -> None:
        """Take a change of an alarm's state, as the buses get it."""
        ...
