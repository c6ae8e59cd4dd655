import itertools

import pytest

from agent.alarms.state import TRANSITIONS, Event, State, next_state

E, S = Event, State


@pytest.mark.parametrize(
    "script",
    [
        # (event, state after it) from normal on
        [(E.RAISE, S.UNACKED_ACTIVE), (E.ACKNOWLEDGE, S.ACKED_ACTIVE), (E.CLEAR, S.NORMAL)],
        [(E.RAISE, S.UNACKED_ACTIVE), (E.CLEAR, S.RETURNED_UNACKED), (E.ACKNOWLEDGE, S.NORMAL)],
        [(E.RAISE, S.UNACKED_ACTIVE), (E.CLEAR, S.RETURNED_UNACKED), (E.RAISE, S.UNACKED_ACTIVE)],
        [(E.RAISE, S.UNACKED_ACTIVE), (E.SHELVE, S.SHELVED), (E.CLEAR, S.SHELVED), (E.UNSHELVE, S.NORMAL)],
        [(E.SHELVE, S.SHELVED), (E.RAISE, S.SHELVED), (E.REMOVE_FROM_SERVICE, S.OUT_OF_SERVICE)],
        [(E.REMOVE_FROM_SERVICE, S.OUT_OF_SERVICE), (E.SHELVE, S.OUT_OF_SERVICE)],
        [(E.REMOVE_FROM_SERVICE, S.OUT_OF_SERVICE), (E.RETURN_TO_SERVICE, S.NORMAL)],
    ],
)
def test_life(script):
    state = S.NORMAL
    for event, expected in script:
        state = next_state(state, event)
        assert state is expected


def test_an_event_that_comes_twice_does_what_it_did_once():
    for state, event in itertools.product(State, Event):
        once = next_state(state, event)
        assert next_state(once, event) is once


def test_every_state_can_be_reached_and_left():
    assert {after for _, after in TRANSITIONS.items()} == set(State)
    assert {before for before, _ in TRANSITIONS} == set(State)


def test_nothing_is_active_while_it_is_silenced():
    assert not any(state.active and state.silenced for state in State)
