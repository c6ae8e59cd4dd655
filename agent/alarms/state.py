"""The ISA-18.2 alarm life cycle as a table: state and event give the next state.

Source: ANSI/ISA-18.2-2016 (IEC 62682), figure of alarm state transitions.

* An active condition is annunciated until a person acknowledges it, even if the condition clears by itself.
* Shelving and removal from service silence an alarm from any state. Its return starts at normal; the caller
  raises the alarm again if the condition is still present.
* An event without meaning in a state leaves the state unchanged, so a repeated event does no harm.
"""

from __future__ import annotations

from enum import StrEnum


class State(StrEnum):
    """State of an alarm."""

    NORMAL = "normal"
    UNACKED_ACTIVE = "unacked_active"
    ACKED_ACTIVE = "acked_active"
    RETURNED_UNACKED = "returned_unacked"
    SHELVED = "shelved"
    OUT_OF_SERVICE = "out_of_service"

    @property
    def active(self) -> bool:
        """Whether the condition is published as present."""
        return self in {State.UNACKED_ACTIVE, State.ACKED_ACTIVE}

    @property
    def silenced(self) -> bool:
        """Whether a person suppressed the alarm."""
        return self in {State.SHELVED, State.OUT_OF_SERVICE}


class Event(StrEnum):
    """An event in the life of an alarm."""

    RAISE = "raise"
    CLEAR = "clear"
    ACKNOWLEDGE = "acknowledge"
    SHELVE = "shelve"
    UNSHELVE = "unshelve"
    REMOVE_FROM_SERVICE = "remove_from_service"
    RETURN_TO_SERVICE = "return_to_service"


_ANNUNCIATING = (State.NORMAL, State.UNACKED_ACTIVE, State.ACKED_ACTIVE, State.RETURNED_UNACKED)

TRANSITIONS: dict[tuple[State, Event], State] = {
    (State.NORMAL, Event.RAISE): State.UNACKED_ACTIVE,
    (State.UNACKED_ACTIVE, Event.ACKNOWLEDGE): State.ACKED_ACTIVE,
    (State.UNACKED_ACTIVE, Event.CLEAR): State.RETURNED_UNACKED,
    (State.ACKED_ACTIVE, Event.CLEAR): State.NORMAL,
    (State.RETURNED_UNACKED, Event.RAISE): State.UNACKED_ACTIVE,
    (State.RETURNED_UNACKED, Event.ACKNOWLEDGE): State.NORMAL,
    (State.SHELVED, Event.UNSHELVE): State.NORMAL,
    (State.OUT_OF_SERVICE, Event.RETURN_TO_SERVICE): State.NORMAL,
    (State.SHELVED, Event.REMOVE_FROM_SERVICE): State.OUT_OF_SERVICE,
    **{(state, Event.SHELVE): State.SHELVED for state in _ANNUNCIATING},
    **{(state, Event.REMOVE_FROM_SERVICE): State.OUT_OF_SERVICE for state in _ANNUNCIATING},
}


def next_state(state: State, event: Event) -> State:
    """Return the state after the event; unchanged where the event has no meaning in this state."""
    return TRANSITIONS.get((state, event), state)
