"""What windows say of S day by day, a valve that is recognised by its former S or not, and repairs."""

import json
import math
import time
from dataclasses import replace

import pytest

from agent.analysis.memory.s_day import MOST, MOST_FOR, TRUST, WRONG, s_seen, with_s
from agent.analysis.memory.state import from_state, to_state
from agent.analysis.memory.valve_memory import DAY, WATCHED, ValveMemory, remember
from agent.analysis.memory.weighing_windows import BASE_RATE
from agent.analysis.wear.as_before import AsBefore
from agent.analysis.wear.trend import trend_of
from tests.unit.memory.windows import HOUR, START, said

MOST_TIME = 0.02
"""CPU of the event loop for a window, s: four to nine milliseconds. It was 40 once."""


def quiet_as(log_ratio):
    """A quiet window, with how its valve agrees with an S of 3."""
    return replace(said(0.5), quantification=None, weighed=None, as_before=AsBefore(3.0, log_ratio))


def test_a_quiet_window_divides_s_where_the_valve_is_known():
    memory = remember(ValveMemory(), quiet_as(-9.0), START, START + HOUR)
    (day,) = memory.s_days
    assert day.divided(recognised=True) == (pytest.approx((1.5, TRUST * -9.0)),)
    assert day.divided(recognised=False)[0][1] == 0.0
    assert remember(ValveMemory(), quiet_as(-400.0), START, START + HOUR).s_days[0].agrees == -MOST
    assert remember(ValveMemory(), quiet_as(400.0), START, START + HOUR).s_days[0].agrees == MOST_FOR


def test_windows_of_a_day_divide_s_once_and_one_that_shows_s_counts_instead():
    memory = ValveMemory()
    for k, log_ratio in enumerate((-9.0, -5.0)):
        memory = remember(memory, quiet_as(log_ratio), START + k * HOUR, START + (k + 1) * HOUR)
    (day,) = memory.s_days
    assert day.agrees == pytest.approx(TRUST * -7.0)
    memory = remember(memory, said(0.9, s=2.0), START + 2 * HOUR, START + 3 * HOUR)
    memory = remember(memory, quiet_as(-9.0), START + 3 * HOUR, START + 4 * HOUR)
    assert [(each.s, each.above) for each in memory.s_days] == [(2.0, None)]


def test_a_bound_of_a_search_stays_where_the_known_valve_agrees_and_goes_where_it_does_not():
    found = [
        s_seen(replace(said(0.2, s=0.4), as_before=AsBefore(3.0, each)), START) for each in (-40.0, 40.0)
    ]
    against, agreeing = (each.divided(recognised=True) for each in found)
    assert against == (pytest.approx((0.44, math.log(WRONG))), pytest.approx((1.5, -MOST - math.log(WRONG))))
    assert agreeing == (pytest.approx((1.5, MOST_FOR)),)
    not_recognised = [each.divided(recognised=False) for each in found]
    assert not_recognised == [(pytest.approx((0.44, math.log(WRONG))),)] * 2


def test_a_comparison_that_hardly_speaks_for_less_takes_nothing_from_a_search_that_does():
    day = s_seen(replace(said(0.2, s=0.4), as_before=AsBefore(3.0, -1.0)), START)
    at_bound, at_half = day.divided(recognised=True)
    assert at_half == pytest.approx((1.5, TRUST * -1.0))
    assert at_bound[1] + at_half[1] == pytest.approx(math.log(WRONG))


def test_the_windows_of_a_day_are_compared_and_searched_each_for_itself():
    searched, compared = said(0.2, s=0.4), quiet_as(-9.0)
    days = ()
    for each in (compared, searched, compared):
        days = with_s(days, s_seen(each, START), 1.0)
    (day,) = days
    assert day.bound == pytest.approx(0.44)
    assert day.above == pytest.approx(math.log(WRONG))
    assert (day.half, day.agrees) == pytest.approx((1.5, TRUST * -9.0))


def test_a_state_of_the_first_version_keeps_days_and_bounds():
    memory = remember(ValveMemory(), said(0.9, s=2.0), START, START + HOUR)
    memory = remember(memory, said(0.2, s=1.0), START + DAY, START + DAY + HOUR)
    content = json.loads(to_state(memory)) | {"version": 1}
    content["s_days"] = [[*each[:4], int(each[4] is not None)] for each in content["s_days"]]
    assert to_state(from_state(json.dumps(content))) == to_state(replace(memory, days=()))


def test_a_state_of_the_second_version_keeps_what_divided_s():
    memory = remember(ValveMemory(), said(0.2, s=1.0), START, START + DAY)
    content = json.loads(to_state(memory)) | {"version": 2, "checks": [40.0]}
    (bound,) = content["s_days"]
    content["s_days"] = [bound[:5], [START + DAY, 1.5 / 1.04, 0.02 * 1.5 / 1.04, 1.0, -7.0]]
    read = from_state(json.dumps(content)).s_days
    assert (read[0].bound, read[0].above) == pytest.approx((1.1, math.log(WRONG)), rel=1e-4)
    assert read[1].divided(recognised=True) == (pytest.approx((1.5, -7.0)),)
    assert read[1].divided(recognised=False)[0][1] == 0.0


@pytest.mark.parametrize(("log_ratio", "repaired"), [(40.0, True), (-40.0, False)])
def test_a_valve_that_is_not_recognised_while_it_sticks_is_not_called_repaired(log_ratio, repaired):
    memory = ValveMemory()
    for k in range(4):
        shown = replace(said(0.9, s=3.0, gain=1.5), as_before=AsBefore(3.0, log_ratio) if k > 1 else None)
        memory = remember(memory, shown, START + k * DAY, START + k * DAY + HOUR)
    for k in range(4, 7):
        memory = remember(memory, quiet_as(-40.0), START + k * DAY, START + k * DAY + HOUR)
    found = trend_of(from_state(to_state(memory)).s_days)
    assert (found.repaired == START + 4 * DAY + HOUR) == repaired
    assert (found.repaired is None) != repaired


def test_a_valve_that_was_repaired_and_shows_it_is_not_compared():
    day = s_seen(replace(said(0.9, s=0.3, gain=1.5), as_before=AsBefore(3.0, -40.0)), START)
    assert day.agrees is None


def compared(memory, ratios, after=0, window=quiet_as):
    for k, log_ratio in enumerate(ratios):
        at = START + (after + k) * DAY
        memory = remember(memory, window(log_ratio), at, at + HOUR)
    return memory


def sticking_as(log_ratio):
    """A window that shows S, and how it agrees with an S of 3."""
    return replace(said(0.985, s=3.0), as_before=AsBefore(3.0, log_ratio))


def test_what_a_valve_showed_before_a_repair_counts_no_more_unless_days_take_it_back():
    sticks = compared(ValveMemory(), [40.0] * 5, window=sticking_as)
    assert sticks.probability() > 0.8
    repaired = from_state(to_state(compared(sticks, [-40.0] * 2, after=5)))
    assert repaired.probability() == pytest.approx(BASE_RATE)
    assert compared(repaired, [-40.0] * 20, after=7).probability() == pytest.approx(BASE_RATE)
    back = compared(repaired, [40.0] * 4, after=7)
    assert back.repaired is None
    assert back.probability() == pytest.approx(sticks.probability(), abs=0.02)


def test_a_valve_that_sticks_again_after_a_repair_is_found_by_its_new_windows():
    memory = compared(ValveMemory(), [40.0] * 5, window=sticking_as)
    memory = compared(memory, [-40.0] * 20, after=5)
    again = compared(memory, [40.0] * 2, after=25, window=sticking_as)
    assert again.probability() > 0.5
    assert again.repaired == memory.repaired


def test_a_search_for_a_repair_hardly_holds_up_the_event_loop():
    """All days that are watched, none of which decides anything: no begin of a stretch is left out."""
    memory = compared(ValveMemory(), [40.0] * 3, window=sticking_as)
    memory = compared(memory, [1.0, -2.0] * ((WATCHED - 4) // 2), after=3)
    at, took = START + (WATCHED - 1) * DAY, []
    for _ in range(5):
        begin = time.thread_time()
        found = remember(memory, quiet_as(-40.0), at, at + HOUR)
        took.append(time.thread_time() - begin)
    assert len(found.s_days) == WATCHED
    assert min(took) < MOST_TIME


def test_a_search_that_finds_nothing_bounds_s_as_far_as_the_window_would_have_shown_it():
    def above(would_show):
        window = said(0.2, s=0.4)
        found = replace(window.quantification, would_show=would_show)
        return s_seen(replace(window, quantification=found), START).above

    assert above(None) == above(1.0) == pytest.approx(math.log(WRONG))
    assert above(0.0) == 0.0
    assert above(1.0) < above(0.6) < above(0.1) < 0
