"""A window whose verdict the former days make improbable: it waits for days that show it, and says so."""

import pytest

from agent.alarms.alarm import Alarm
from agent.alarms.delay import Delay
from agent.alarms.state import State
from agent.analysis.memory.sticks import is_suspected, with_memory
from agent.analysis.memory.valve_memory import DAY, ValveMemory, remember
from agent.report.reasons import reasons
from agent.runtime.store.kept_window import is_of_interest
from tests.unit.memory.windows import HOUR, START, said


def hour_of_day(k):
    return START + k * DAY, START + k * DAY + HOUR


def sound_days(count):
    memory = ValveMemory()
    for k in range(count):
        memory = remember(memory, said(0.02, verdict="no_stiction"), *hour_of_day(k))
    return memory


def test_the_verdict_of_a_window_that_former_days_make_improbable_waits_for_days_that_show_it():
    memory = sound_days(20)
    verdicts = []
    for k in range(20, 24):
        alone = said(0.985, verdict="stiction")
        memory = remember(memory, alone, *hour_of_day(k))
        whole = with_memory(alone, memory)
        verdicts.append(whole.verdict)
        assert whole.contradicted == (whole.verdict == "undecided")
        assert (whole.sticks.probability > 0.5) == (whole.verdict == "stiction")
    assert verdicts[0] == "undecided"
    assert verdicts[-1] == "stiction"


def test_a_verdict_that_waits_says_so_and_raises_no_alarm():
    memory = sound_days(20)
    alone = said(0.985, verdict="stiction")
    memory = remember(memory, alone, *hour_of_day(20))
    waits = with_memory(alone, memory)
    assert (waits.cause, waits.confidence, waits.stiction_class, waits.benefit) == (
        "undecided",
        0.0,
        None,
        None,
    )
    assert waits.quantification == alone.quantification
    assert "the verdict waits for another day" in reasons(waits)[0]
    assert not is_suspected(waits)
    assert is_of_interest(waits, alarmed=False)
    alarm, _ = Alarm("FIC101", delay=Delay(on=1, off=1)).on_diagnosis(waits, memory.until)
    assert alarm.state is State.NORMAL


def test_windows_of_the_same_day_do_not_make_a_verdict_wait():
    memory = ValveMemory()
    for k in range(20):
        memory = remember(memory, said(0.02, verdict="no_stiction"), START + k * HOUR, START + (k + 1) * HOUR)
    alone = said(0.985, verdict="stiction")
    memory = remember(memory, alone, START + 20 * HOUR, START + 21 * HOUR)
    assert memory.probability() < 0.5
    assert with_memory(alone, memory).verdict == "stiction"


@pytest.mark.parametrize("base_rate", [0.01, 0.2, 0.9])
def test_a_valve_without_former_days_never_waits(base_rate):
    alone = said(0.985, verdict="stiction")
    memory = remember(ValveMemory(), alone, START, START + HOUR)
    assert with_memory(alone, memory, base_rate).verdict == "stiction"
