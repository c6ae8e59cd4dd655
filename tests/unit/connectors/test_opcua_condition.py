"""An alarm as a condition of OPC UA: what each state means there, and which EventIds may still be used."""

import pytest
from pydantic import ValidationError

from agent.alarms import State
from agent.settings import AlarmSettings
from connectors.opcua_server.alarm.condition import SEVERITIES, STATES, Condition
from connectors.opcua_server.options import OpcUaServerOptions
from tests.unit.connectors.alarm_messages import told

SECURITY = {"certificate": "a.pem", "key": "k.pem", "ca": "ca.pem"}
SECRET = {"env": "SLIPJUMP_TEST"}


def after(*states, **fields):
    condition = Condition("FIC101")
    for at, state in enumerate(states):
        condition = condition.after(told("FIC101", state, at=float(at), **fields))
    return condition


def test_every_state_and_priority_of_the_agent_is_known():
    assert set(STATES) == set(State)
    assert {state: active for state, (active, _) in STATES.items()} == {s: s.active for s in State}
    priorities = AlarmSettings.model_json_schema()["properties"]["priority"]["enum"]
    assert list(SEVERITIES) == priorities
    assert list(SEVERITIES.values()) == sorted(SEVERITIES.values())


@pytest.mark.parametrize("state", State)
def test_what_is_retained_is_all_that_somebody_may_want_to_change(state):
    condition = after(state)
    assert condition.retain == (state is not State.NORMAL)
    assert condition.acked == (state not in {State.UNACKED_ACTIVE, State.RETURNED_UNACKED})


def test_a_message_that_reports_nothing_new_is_no_event():
    condition = after("unacked_active")
    assert condition.after(told("FIC101", "unacked_active", "event", at=0.0)) is condition
    assert condition.after(told("FIC101", "unacked_active", at=9.0, s=5.0, verdict="undecided")) is condition
    assert condition.after(told("FIC101", "unacked_active", at=9.0, id="FIC101/2")) is not condition


def test_an_event_id_counts_until_its_activation_is_acknowledged_or_over():
    raised = after("unacked_active")
    returned = raised.after(told("FIC101", "returned_unacked", at=1.0))
    assert returned.event_ids == (raised.event_id, returned.event_id)
    acked = returned.after(told("FIC101", "normal", at=2.0))
    assert acked.event_ids == (acked.event_id,)
    again = returned.after(told("FIC101", "unacked_active", at=3.0, id="FIC101/2"))
    assert again.event_ids == (again.event_id,)
    restarted = after("unacked_active")
    assert restarted.event_id == raised.event_id


def test_comments_are_events_and_bounded():
    condition = after("unacked_active")
    for n in range(100):
        condition = condition.commented("again", "jane", 10.0 + n)
    assert len(condition.event_ids) == 16
    assert len(set(condition.event_ids)) == 16
    assert condition.after(told("FIC101", "unacked_active", at=9.0)) is condition


def test_times_of_change():
    condition = after("unacked_active", "acked_active", "normal")
    assert (condition.at, condition.active_since, condition.acked_since) == (2.0, 2.0, 1.0)


@pytest.mark.parametrize(
    ("options", "fault"),
    [
        ({"host": "0.0.0.0"}, "open to other machines"),  # noqa: S104 - refused
        ({"host": "plant.example"}, "open to other machines"),
        ({"users": {"jane": {"password": SECRET}}}, "users need security"),
        ({"anonymous": "refused"}, "nobody may connect"),
        ({"security": {**SECURITY, "ca": None}}, "who may connect"),
        ({"security": SECURITY, "unprotected": True}, "contradicts"),
        (
            {"security": SECURITY, "users": {"jane": {"password": "in the open"}}},
            "does not belong in this file",
        ),
    ],
)
def test_what_would_leave_the_server_open_must_be_requested(options, fault):
    with pytest.raises(ValidationError, match=fault):
        OpcUaServerOptions.model_validate(options)


@pytest.mark.parametrize(
    "options",
    [
        {},
        {"host": "::1"},
        {"host": "localhost", "anonymous": "order"},
        {"host": "0.0.0.0", "unprotected": True},  # noqa: S104 - asked for
        {"host": "0.0.0.0", "security": SECURITY, "users": {"jane": {"password": SECRET}}},  # noqa: S104
    ],
)
def test_what_may_be_requested(options):
    OpcUaServerOptions.model_validate(options)
