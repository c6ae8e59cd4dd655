"""What a person decided about an alarm, as a value."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from agent.alarms.state import Event

EVENTS: Mapping[str, Event] = {
    "acknowledge": Event.ACKNOWLEDGE,
    "shelve": Event.SHELVE,
    "unshelve": Event.UNSHELVE,
    "out_of_service": Event.REMOVE_FROM_SERVICE,
    "in_service": Event.RETURN_TO_SERVICE,
}
"""What a person may ask for, in the words of the buses and of the command line."""


@dataclass(frozen=True, slots=True)
class Command:
    """One decision; raises ValueError where it makes no sense."""

    event: Event
    """Acknowledge, shelve, unshelve, remove from or return to service."""
    by: str
    """Who decided."""
    at: float
    """When, s UTC."""
    until: float | None = None
    """End of shelving, s UTC; None for all other events. ISA-18.2 knows no shelving without an end."""

    @classmethod
    def asked(cls, action: str, by: str, at: float, until: float | None = None) -> Command:
        """Return the command for one of the words of ``EVENTS``; raises ValueError."""
        if action not in EVENTS:
            raise ValueError(f"expected one of {', '.join(EVENTS)}")
        return cls(EVENTS[action], by, at, until)

    def __post_init__(self) -> None:
        if self.event in {Event.RAISE, Event.CLEAR}:
            raise ValueError(f"{self.event} is for the diagnosis to say, not for a person")
        if not self.by:
            raise ValueError("somebody must have decided it")
        if not math.isfinite(self.at):
            raise ValueError("it must have been decided at some time")
        if (self.event is Event.SHELVE) != (self.until is not None):
            raise ValueError("shelving has an end, and nothing else has")
        if self.until is not None and not self.at < self.until < math.inf:
            raise ValueError("shelving must end after it began")
