"""The ISA-18.2 life cycle as a table: state and event give the next state.

Source: ANSI/ISA-18.2-2016 (IEC 62682), figure of alarm state transitions.

* A condition that comes is annunciated until somebody acknowledges it, even if it goes by itself.
* Shelving and taking out of service silence an alarm from any state. Coming back starts at normal; the caller
  raises anew if the condition is still there.
* An event that means nothing in a state leaves it as it is, so a repeated event does no harm.
"""

from __future__ import annotations

from enum import StrEnum


class State(StrEnum):
    """Where an alarm is in its life."""

    NORMAL = "normal"
    UNACKED_ACTIVE = "unacked_active"
    ACKED_ACTIVE = "acked_active"
    RETURNED_UNACKED = "returned_unacked"
    SHELVED = "shelved"
    OUT_OF_SERVICE = "out_of_service"

    @property
    def active(self) -> bool:
        """Whether a consumer is told that the condition is there."""
        return self in {State.UNACKED_ACTIVE, State.ACKED_ACTIVE}

    @property
    def silenced(self) -> bool:
        """Whether someone decided not to be told."""
        return self in {State.SHELVED, State.OUT_OF_SERVICE}


class Event(StrEnum):
    """What can happen to an alarm."""

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
    """State after the event; the same where the event means nothing."""
    return TRANSITIONS.get((state, event), state)
