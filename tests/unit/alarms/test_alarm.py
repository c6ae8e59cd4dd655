import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from agent.alarms import Alarm, Command, Delay, DeviceHealth, Event, State
from agent.analysis.diagnosis import Diagnosis
from agent.analysis.results import Quantification, StictionEstimate
from agent.units import FrictionBands


def diagnosis(verdict):
    found = StictionEstimate.of(FrictionBands(f_s=3.0, f_d=1.0)) if verdict == "stiction" else None
    return Diagnosis(
        loop="FIC101",
        verdict=verdict,
        confidence=1.0,
        cause="undecided",
        causes=(),
        stiction_class=None,
        oscillation=None,
        quantification=Quantification("any", found, None, None, None, None, "undecided"),
    )


def play(alarm, verdicts, start=0.0):
    """The alarm and the states after each verdict, one window every 100 s."""
    states = []
    for k, verdict in enumerate(verdicts):
        alarm, _ = alarm.on_diagnosis(diagnosis(verdict), start + 100.0 * k)
        states.append(alarm.state)
    return alarm, states


def test_it_comes_after_the_on_delay_and_goes_after_the_off_delay():
    alarm = Alarm("FIC101", delay=Delay(on=3, off=2))
    alarm, states = play(alarm, ["stiction"] * 3 + ["no_stiction"] * 2)
    assert states == [State.NORMAL] * 2 + [State.UNACKED_ACTIVE] * 2 + [State.RETURNED_UNACKED]


def test_an_undecided_window_counts_towards_neither():
    alarm = Alarm("FIC101", delay=Delay(on=2, off=2))
    alarm, states = play(alarm, ["stiction", "undecided", "not_testable", "stiction"])
    assert states[-2:] == [State.NORMAL, State.UNACKED_ACTIVE]
    alarm, states = play(alarm, ["no_stiction", "undecided", "not_testable", "no_stiction"])
    assert states[-2:] == [State.UNACKED_ACTIVE, State.RETURNED_UNACKED]


def test_a_window_that_says_the_opposite_starts_the_count_anew():
    alarm = Alarm("FIC101", delay=Delay(on=2, off=2))
    _, states = play(alarm, ["stiction", "no_stiction", "stiction", "no_stiction"])
    assert set(states) == {State.NORMAL}


def test_the_id_is_that_of_the_activation():
    alarm, _ = play(Alarm("FIC101", delay=Delay(on=1, off=1)), ["stiction", "stiction"], start=100.0)
    first = alarm.id
    assert first == "FIC101/100.000000"
    alarm, _ = alarm.on_command(Command(Event.ACKNOWLEDGE, "jane", 250.0))
    assert alarm.id == first
    alarm, _ = play(alarm, ["no_stiction", "stiction"], start=300.0)
    assert alarm.id == "FIC101/400.000000"


def test_state_is_announced_each_window_and_an_event_at_each_change():
    alarm = Alarm("FIC101", delay=Delay(on=2, off=1))
    kinds = []
    for k, verdict in enumerate(["stiction", "stiction", "stiction", "no_stiction"]):
        alarm, announcements = alarm.on_diagnosis(diagnosis(verdict), float(k))
        kinds.append([a.kind for a in announcements])
    assert kinds == [["state"], ["state", "event"], ["state"], ["state", "event"]]


def test_what_is_announced_fits_a_bus():
    _, announcements = Alarm("FIC101", delay=Delay(1, 1)).on_diagnosis(diagnosis("stiction"), 7.0)
    fields = announcements[1].fields()
    assert fields == {
        "schema": 2,
        "message_id": "FIC101/7.000000/event/unacked_active",
        "loop": "FIC101",
        "id": "FIC101/7.000000",
        "active": True,
        "state": "unacked_active",
        "verdict": "stiction",
        "priority": "medium",
        "ne107": "maintenance_required",
        "health": 4,
        "time": 7.0,
        "by": None,
        "until": None,
        "f_s": 3.0,
        "f_d": 1.0,
        "s": 4.0,
        "s_low": None,
        "s_high": None,
        "j": 2.0,
        "j_low": None,
        "j_high": None,
        "s_identifiable": None,
        "j_identifiable": None,
        "probability": None,
        "advisory": "none",
        "no_response": None,
    }
    assert json.dumps(fields, allow_nan=False)
    assert announcements[0].id != announcements[1].id


def test_the_amount_stays_while_it_is_active_and_goes_with_it():
    alarm, _ = play(Alarm("FIC101", delay=Delay(1, 2)), ["stiction", "no_stiction"])
    assert alarm.stiction is not None
    alarm, _ = play(alarm, ["no_stiction"])
    assert alarm.stiction is None


def test_a_shelved_alarm_is_silent_and_comes_back_if_the_condition_is_still_there():
    alarm, _ = play(Alarm("FIC101", delay=Delay(1, 1)), ["stiction"])
    alarm, _ = alarm.on_command(Command(Event.SHELVE, "jane", 10.0, until=1e4))
    alarm, announcements = alarm.on_diagnosis(diagnosis("stiction"), 100.0)
    assert not announcements[0].fields()["active"]
    alarm, announcements = alarm.on_command(Command(Event.UNSHELVE, "jane", 200.0))
    assert alarm.state is State.UNACKED_ACTIVE
    assert [a.kind for a in announcements] == ["state", "event"]


def test_a_shelved_alarm_comes_back_as_normal_if_the_condition_went():
    alarm, _ = play(Alarm("FIC101", delay=Delay(1, 1)), ["stiction"])
    alarm, _ = alarm.on_command(Command(Event.SHELVE, "jane", 10.0, until=1e4))
    alarm, _ = play(alarm, ["no_stiction"], start=100.0)
    alarm, _ = alarm.on_command(Command(Event.UNSHELVE, "jane", 200.0))
    assert alarm.state is State.NORMAL


def test_decisions_within_a_millisecond_have_ids_of_their_own():
    alarm, _ = play(Alarm("FIC101", delay=Delay(1, 1)), ["stiction"])
    ids = []
    for k, event in enumerate([Event.SHELVE, Event.UNSHELVE] * 3):
        at = 1_790_000_000.0 + k * 1e-4
        until = at + 60.0 if event is Event.SHELVE else None
        alarm, announcements = alarm.on_command(Command(event, "jane", at, until))
        ids += [each.id for each in announcements]
    assert len(ids) == len(set(ids)) == 12


def test_an_acknowledgement_of_nothing_announces_nothing():
    assert Alarm("FIC101").on_command(Command(Event.ACKNOWLEDGE, "jane", 0.0))[1] == ()


@pytest.mark.parametrize("event", [Event.RAISE, Event.CLEAR])
def test_only_the_diagnosis_raises_and_clears(event):
    with pytest.raises(ValueError, match="a person cannot command it"):
        Command(event, "jane", 0.0)


@pytest.mark.parametrize(
    "arguments",
    [
        {"event": Event.ACKNOWLEDGE, "by": "", "at": 0.0},
        {"event": Event.ACKNOWLEDGE, "by": "jane", "at": float("nan")},
        {"event": Event.ACKNOWLEDGE, "by": "jane", "at": 0.0, "until": 9.0},
        {"event": Event.SHELVE, "by": "jane", "at": 0.0},
        {"event": Event.SHELVE, "by": "jane", "at": 9.0, "until": 9.0},
        {"event": Event.SHELVE, "by": "jane", "at": 9.0, "until": float("inf")},
    ],
)
def test_a_command_that_makes_no_sense_is_refused(arguments):
    with pytest.raises(ValueError, match=r"\w"):
        Command(**arguments)


def test_shelving_ends_by_itself_and_the_alarm_is_announced_again():
    alarm, _ = play(Alarm("FIC101", delay=Delay(1, 1)), ["stiction"])
    alarm, _ = alarm.on_command(Command(Event.SHELVE, "jane", 10.0, until=500.0))
    assert (alarm.by, alarm.until) == ("jane", 500.0)
    assert alarm.on_clock(499.9) == (alarm, ())
    alarm, announcements = alarm.on_clock(500.0)
    assert (alarm.state, alarm.by, alarm.until) == (State.UNACKED_ACTIVE, None, None)
    assert [a.kind for a in announcements] == ["state", "event"]


def test_shelving_again_sets_the_end_anew_and_is_no_event():
    alarm, _ = Alarm("FIC101").on_command(Command(Event.SHELVE, "jane", 10.0, until=500.0))
    alarm, announcements = alarm.on_command(Command(Event.SHELVE, "joe", 20.0, until=900.0))
    assert (alarm.state, alarm.by, alarm.until) == (State.SHELVED, "joe", 900.0)
    assert [a.kind for a in announcements] == ["state"]


def test_it_names_who_acknowledged_until_the_state_changes():
    alarm, _ = play(Alarm("FIC101", delay=Delay(1, 1)), ["stiction"])
    alarm, announcements = alarm.on_command(Command(Event.ACKNOWLEDGE, "jane", 50.0))
    assert announcements[1].fields()["by"] == "jane"
    alarm, _ = alarm.on_command(Command(Event.ACKNOWLEDGE, "joe", 60.0))
    alarm, _ = play(alarm, ["stiction"], start=100.0)
    assert alarm.by == "jane"
    alarm, _ = play(alarm, ["no_stiction"], start=200.0)
    assert (alarm.state, alarm.by) == (State.NORMAL, None)


def test_out_of_service_is_a_function_check_and_ends_only_by_a_command():
    alarm, _ = play(Alarm("FIC101", delay=Delay(1, 1)), ["stiction"])
    alarm, _ = alarm.on_command(Command(Event.REMOVE_FROM_SERVICE, "jane", 10.0))
    alarm, _ = play(alarm, ["stiction", "no_stiction", "stiction"], start=100.0)
    assert (alarm.state, alarm.health) == (State.OUT_OF_SERVICE, DeviceHealth.FUNCTION_CHECK)
    alarm, _ = alarm.on_command(Command(Event.RETURN_TO_SERVICE, "jane", 900.0))
    assert (alarm.state, alarm.health) == (State.UNACKED_ACTIVE, DeviceHealth.MAINTENANCE_REQUIRED)
    assert alarm.id == "FIC101/900.000000"


def test_what_was_kept_goes_on_with_the_settings_of_today():
    kept, _ = play(Alarm("FIC101", delay=Delay(2, 2)), ["stiction"] * 2 + ["no_stiction"])
    alarm = Alarm("FIC101", "high", Delay(5, 4)).resumed(kept)
    assert (alarm.state, alarm.id, alarm.priority) == (State.UNACKED_ACTIVE, kept.id, "high")
    assert alarm.delay == Delay(5, 4, there=True, run=1)


@given(
    st.lists(st.sampled_from(["stiction", "no_stiction", "undecided", "not_testable"]), max_size=60),
    st.integers(1, 4),
    st.integers(1, 4),
)
def test_the_delay_says_what_a_look_at_all_windows_says(verdicts, on, off):
    alarm, _ = play(Alarm("FIC101", delay=Delay(on, off)), verdicts)
    there, firm = False, []
    for verdict in verdicts:
        if verdict in {"stiction", "no_stiction"}:
            firm.append(verdict)
        if not there and firm[-on:] == ["stiction"] * on:
            there = True
        elif there and firm[-off:] == ["no_stiction"] * off:
            there = False
    assert alarm.state.active == there
