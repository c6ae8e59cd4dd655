"""An alarm in the terms of OPC UA Part 9; pure.

Source: OPC 10000-9 (Alarms and Conditions) 1.05, 5.5 to 5.8.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from datetime import UTC, datetime

from connectors.base import JsonValue, Publication

SEVERITIES = {"low": 200, "medium": 500, "high": 700, "critical": 900}
"""Priority -> severity of 1 to 1000: the middle of each quarter, Part 5, 6.4.2."""
STATES = {
    "normal": (False, True),
    "unacked_active": (True, False),
    "acked_active": (True, True),
    "returned_unacked": (False, False),
    "shelved": (False, True),
    "out_of_service": (False, True),
}
"""State of ISA-18.2 -> whether it is active, whether nobody need acknowledge it."""
_UNKNOWN = (False, True)
_MESSAGES = {
    "normal": "valve does not stick",
    "unacked_active": "valve sticks{bands}",
    "acked_active": "valve sticks{bands}, acknowledged{by}",
    "returned_unacked": "valve no longer sticks, nobody acknowledged",
    "shelved": "shelved{by}{until}",
    "out_of_service": "out of service{by}",
}


@dataclass(frozen=True, slots=True)
class Condition:
    """Where the alarm of one loop stands. Immutable; ``after`` makes the one that follows."""

    loop: str
    state: str | None = None
    """Of ISA-18.2; None before the first publication."""
    activation: str | None = None
    """Id of the present or last activation."""
    severity: int = 0
    """1 to 1000; 0 before the first publication."""
    last_severity: int = 0
    """Before the last change."""
    by: str | None = None
    """Who brought it into its state."""
    user: str = ""
    """Who did something with it last, a comment included."""
    until: float | None = None
    """End of shelving, s UTC."""
    at: float | None = None
    """When it came into its state, s UTC."""
    active_since: float | None = None
    """Last change of ``active``, s UTC."""
    acked_since: float | None = None
    """Last change of ``acked``, s UTC."""
    message: str = ""
    comment: str = ""
    comment_at: float | None = None
    """When somebody wrote the comment, s UTC."""
    event_ids: tuple[bytes, ...] = ()
    """Of all events since nobody need acknowledge, the newest last: an operator may acknowledge by these."""

    @property
    def active(self) -> bool:
        """Whether the condition is there."""
        return STATES.get(self.state or "", _UNKNOWN)[0]

    @property
    def acked(self) -> bool:
        """Whether nobody need acknowledge it."""
        return STATES.get(self.state or "", _UNKNOWN)[1]

    @property
    def shelved(self) -> bool:
        """Whether it is silent for some time."""
        return self.state == "shelved"

    @property
    def out_of_service(self) -> bool:
        """Whether it is silent until further notice."""
        return self.state == "out_of_service"

    @property
    def retain(self) -> bool:
        """Whether a client that comes later wants to know it, Part 9, 5.5.2."""
        return self.state not in {None, "normal"}

    @property
    def event_id(self) -> bytes:
        """Of the newest event; empty before the first."""
        return self.event_ids[-1] if self.event_ids else b""

    def after(self, publication: Publication) -> Condition:
        """Return the condition after a publication; the same one where nothing is new."""
        told = publication.fields
        state, at = str(told.get("state")), _number(told.get("time")) or 0.0
        new = replace(
            self,
            state=state,
            activation=_text(told.get("id")),
            severity=SEVERITIES.get(str(told.get("priority")), SEVERITIES["medium"]),
            by=_text(told.get("by")),
            until=_number(told.get("until")),
        )
        if new == self:
            return self
        return replace(
            new,
            at=at,
            user=new.by or self.user,
            last_severity=self.severity or new.severity,
            active_since=self.active_since if new.active == self.active and self.state else at,
            acked_since=self.acked_since if new.acked == self.acked and self.state else at,
            message=_message(state, told),
            event_ids=self._ids(new, f"{self.loop}/{at:.6f}/{state}"),
        )

    def remarked(self, comment: str, user: str, at: float) -> Condition:
        """Return the condition with what ``user`` wrote at ``at``, s UTC; it is sent with the next event."""
        return replace(self, comment=comment, comment_at=at, user=user)

    def commented(self, comment: str, user: str, at: float) -> Condition:
        """Return the condition with what ``user`` wrote, which is an event of its own."""
        told = self.remarked(comment, user, at)
        return replace(told, event_ids=self._ids(told, f"{self.loop}/{at:.6f}/comment"))

    def _ids(self, new: Condition, event: str) -> tuple[bytes, ...]:
        same = new.activation == self.activation and new.acked == self.acked
        return (*(self.event_ids[-15:] if same else ()), event.encode())


def _message(state: str, told: Mapping[str, JsonValue]) -> str:
    by, until = _text(told.get("by")), _number(told.get("until"))
    bands = [
        f"{name} {value:.3g}"
        for name, key in (("S", "s"), ("J", "j"))
        if (value := _number(told.get(key))) is not None
    ]
    return _MESSAGES.get(state, state).format(
        bands=f": {', '.join(bands)}" if bands else "",
        by=f" by {by}" if by else "",
        until="" if until is None else f" until {datetime.fromtimestamp(until, UTC):%Y-%m-%d %H:%M:%S} UTC",
    )


def _text(value: JsonValue) -> str | None:
    return None if value is None else str(value)


def _number(value: JsonValue) -> float | None:
    return float(value) if isinstance(value, int | float) else None
