"""A person's command to an alarm, as a value."""

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
"""Action word, as used on the buses and on the command line -> event."""


@dataclass(frozen=True, slots=True)
class Command:
    """One command; raises ValueError where its fields contradict each other."""

    event: Event
    """Acknowledge, shelve, unshelve, remove from or return to service."""
    by: str
    """Name of the person."""
    at: float
    """Time of the command, s UTC."""
    until: float | None = None
    """End of shelving, s UTC; None for all other events. ISA-18.2 has no shelving without an end."""

    @classmethod
    def of_action(cls, action: str, by: str, at: float, until: float | None = None) -> Command:
        """Return the command for one of the words of ``EVENTS``; raises ValueError."""
        if action not in EVENTS:
            raise ValueError(f"expected one of {', '.join(EVENTS)}")
        return cls(EVENTS[action], by, at, until)

    def __post_init__(self) -> None:
        if self.event in {Event.RAISE, Event.CLEAR}:
            raise ValueError(f"{self.event} follows from a diagnosis; a person cannot command it")
        if not self.by:
            raise ValueError("expected the name of the person who decided")
        if not math.isfinite(self.at):
            raise ValueError("expected a finite time of the command")
        if (self.event is Event.SHELVE) != (self.until is not None):
            raise ValueError("expected an end time for shelve, and for no other command")
        if self.until is not None and not self.at < self.until < math.inf:
            raise ValueError("the end of shelving must be after its start")
