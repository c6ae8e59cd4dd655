"""What the benchmark counts of a trend: days whose interval holds, and days to a repair that is noticed."""

from agent.analysis.memory.outcome import OUTCOMES
from agent.analysis.memory.s_day import SDay, with_s
from agent.analysis.memory.valve_memory import ValveMemory
from benchmarks.cases.followed import days_held, found_after, repair_noticed
from benchmarks.cases.weeks import DiagnosedValve

DAY = 86400.0


def valve(true_s, seen):
    memories, days = [], ()
    for k, s in enumerate(seen):
        days = with_s(days, SDay(k * DAY, s, 0.1 * s, 1.0), 1.0)
        memories.append(ValveMemory(until=k * DAY, s_days=days))
    count = len(seen)
    return DiagnosedValve(
        "one", True, tuple(map(float, range(count))), true_s, tuple(memories), (True,) * count
    )


def test_days_whose_interval_has_the_true_s_are_counted():
    assert days_held(valve((3.0,) * 10, [3.0] * 10)) == (10, 10)
    assert days_held(valve((30.0,) * 10, [3.0] * 10)) == (0, 10)
    assert days_held(valve((3.0,) * 2, [3.0] * 2)) == (0, 0)


def test_the_days_to_a_repair_that_is_noticed_are_counted():
    true = (4.0,) * 10 + (0.2,) * 5
    found = repair_noticed(valve(true, true), 9.5)
    assert found is not None
    assert found <= 2.5
    assert repair_noticed(valve((4.0,) * 15, (4.0,) * 15), 9.5) is None


def test_the_days_to_an_onset_that_is_found_are_counted():
    looks = [
        ValveMemory(today=tuple(float(each == name) for each in OUTCOMES)) for name in ("against", "strong")
    ]
    memories = (looks[0],) * 4 + (looks[1],)
    days = tuple(map(float, range(5)))
    one = DiagnosedValve("one", True, days, (0.0,) * 5, memories, (False,) * 5)
    assert found_after(one, 1.5, 0.5) == 2.5
    assert found_after(one, 1.5, 0.99) is None
