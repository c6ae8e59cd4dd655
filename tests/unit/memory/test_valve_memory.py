"""What is remembered of a valve: no window twice, days as one, forgetting, the cap, the state as text."""

import json
import math
from dataclasses import replace

import pytest

from agent.analysis.evidence.weighing import SURE, Weighed
from agent.analysis.memory.known import known_from
from agent.analysis.memory.outcome import OUTCOMES, outcome_of
from agent.analysis.memory.rates import MIMICS
from agent.analysis.memory.s_day import MOST, MOST_FOR, TRUST, WRONG, s_seen, with_s
from agent.analysis.memory.state import from_state, to_state
from agent.analysis.memory.sticks import LIKELY, is_suspected, sticks_of, with_memory
from agent.analysis.memory.valve_memory import (
    DAY,
    HALF_LIFE,
    PROCESSES,
    ValveMemory,
    hints_from,
    remember,
)
from agent.analysis.memory.weighing_windows import BASE_RATE, log_bayes_factor, probability_of
from agent.analysis.record.recording import LoopHints
from agent.analysis.results import IntervalEstimate, ProcessEstimate, ProcessIntervals
from agent.analysis.wear.as_before import AsBefore
from agent.analysis.wear.trend import trend_of
from agent.report.ranking import group_of
from tests.unit.analysis.diagnoses import STICKING, WINDOW, judged

START = 1.7e9 - 1.7e9 % DAY
HOUR = 3600.0
ALONE = judged(WINDOW, STICKING)


def said(probability, s=None, gain=None, verdict="undecided"):
    """A diagnosis whose window alone gives ``probability``."""
    found = ALONE.quantification
    stiction = found.stiction
    if s is not None:
        stiction = replace(stiction, s=IntervalEstimate(s, 0.9 * s, 1.1 * s))
    process = None
    if gain is not None:
        ends = ProcessIntervals((0.9 * gain, 1.1 * gain), (4.0, 6.0), (1.0, 3.0))
        process = ProcessEstimate("fopdt", gain, 5.0, 2.0, intervals=ends)
    found = replace(found, stiction=stiction, process=process)
    return replace(
        ALONE, verdict=verdict, quantification=found, weighed=Weighed(probability, ()), no_response=None
    )


def counts(**of):
    return tuple(float(of.get(each, 0.0)) for each in OUTCOMES)


@pytest.mark.parametrize(
    ("probability", "outcome"),
    [
        (0.05, "against"),
        (0.2, "hardly"),
        (0.45, "weak"),
        (0.7, "fair"),
        (0.95, "strong"),
        (0.985, "very_strong"),
    ],
)
def test_a_window_has_the_outcome_of_its_odds(probability, outcome):
    assert outcome_of(said(probability)) == outcome


def test_what_is_not_testable_says_nothing():
    assert outcome_of(replace(said(0.5), verdict="not_testable", weighed=None)) is None


def test_quiet_windows_leave_the_probability_as_it_is():
    memory = ValveMemory()
    for k in range(50):
        quiet = replace(said(0.5), verdict="no_stiction", weighed=None)
        memory = remember(memory, quiet, START + k * DAY, START + k * DAY + HOUR)
    assert memory.probability() == pytest.approx(0.2)


def test_quiet_records_count_as_one_together():
    """In a quiet record of any valve nothing is seen; several do not add up as others do."""
    nothing = {"log_likelihood_ratio": 0.0, "evidence": 1.0, "quick_evidence": 1.0, "turns": 0}
    against = judged(WINDOW, replace(STICKING, decision="undecided", **nothing))
    against = replace(against, methods={}, no_response=None)
    quiet, moving = replace(against, quiet=True), replace(against, quiet=False)
    alone = sticks_of([quiet])
    assert alone == sticks_of([moving])
    assert sticks_of([quiet] * 5) == alone
    assert sticks_of([moving] * 5).probability < alone.probability < 0.2
    assert sticks_of([quiet] * 5 + [moving]) == sticks_of([moving] * 2)


def test_a_slip_in_one_of_many_quiet_records_is_not_outweighed():
    slip = replace(said(0.9), quiet=True)
    nothing = {"log_likelihood_ratio": 0.0, "evidence": 1.0, "quick_evidence": 1.0, "turns": 0}
    quiet = [replace(judged(WINDOW, replace(STICKING, decision="undecided", **nothing)), quiet=True)] * 3
    counted = [replace(each, quiet=False, no_response=None) for each in (*quiet, slip)]
    quiet = [replace(each, no_response=None) for each in quiet]
    assert sticks_of([*quiet, slip]).probability > sticks_of(counted).probability


def test_what_is_enough_for_the_verdict_is_more_likely_than_not():
    assert sticks_of([replace(said(0.9), weighed=Weighed(SURE, ()))]).probability > LIKELY


def test_without_evidence_the_probability_is_the_base_rate():
    assert ValveMemory().probability() == pytest.approx(0.2)
    assert ValveMemory().probability(0.35) == pytest.approx(0.35)


@pytest.mark.parametrize("outcome", OUTCOMES)
def test_many_windows_do_not_add_up_to_certainty(outcome):
    """The odds rise by no more than the part of the sound valves that look like sticking ones allows."""
    many = [log_bayes_factor(counts(**{outcome: n})) for n in (1, 10, 100, 1000, 10000)]
    assert max(many) <= math.log(1 / MIMICS)
    assert probability_of(counts(very_strong=1000)) == pytest.approx(1 / (1 + 4 * MIMICS), abs=0.001)


def test_contrary_windows_bring_the_odds_back():
    assert probability_of(counts(very_strong=5, against=5)) < probability_of(counts(very_strong=5))
    assert probability_of(counts(against=30, very_strong=1)) < probability_of(counts(very_strong=1)) / 2


def test_every_further_window_for_stiction_raises_the_odds():
    for outcome in ("strong", "very_strong"):
        odds = [probability_of(counts(**{outcome: n})) for n in range(6)]
        assert odds == sorted(odds)
    assert probability_of(counts(against=5)) < probability_of(counts(against=1)) < 0.2


def test_no_window_counts_twice_and_an_overlap_counts_once():
    once = remember(ValveMemory(), said(0.9), START, START + HOUR)
    assert once.windows == 1.0
    assert remember(once, said(0.9), START, START + HOUR) is once
    assert remember(once, said(0.9), START - HOUR, START) is once
    half = remember(once, said(0.1), START + HOUR / 2, START + 1.5 * HOUR)
    assert half.today == pytest.approx(counts(strong=1.0, against=0.5))


def test_a_day_counts_as_one_window():
    memory = ValveMemory()
    for k in range(20):
        memory = remember(memory, said(0.9), START + k * HOUR, START + (k + 1) * HOUR)
    assert memory.windows == pytest.approx(1.0)
    memory = remember(memory, said(0.9), START + DAY, START + DAY + HOUR)
    assert memory.windows == pytest.approx(2.0, abs=0.02)


def test_old_windows_are_forgotten_at_the_stated_rate():
    memory = remember(ValveMemory(), said(0.985), START, START + HOUR)
    later = START + HOUR + HALF_LIFE
    memory = remember(memory, said(0.05), later - HOUR, later)
    assert memory.counts == pytest.approx(counts(very_strong=0.5, against=1.0), abs=1e-3)


def test_the_process_is_what_windows_agree_on():
    memory = ValveMemory()
    for k, gain in enumerate((1.4, 1.5, 1.6, -3.0)):
        memory = remember(memory, said(0.5, gain=gain), START + k * DAY, START + k * DAY + HOUR)
    known = hints_from(memory, LoopHints()).known
    assert known.gain == pytest.approx(1.5)
    assert known.log_gain_sd < 0.3
    assert known_from(memory.processes[:1]) is None
    assert known_from((memory.processes[0], replace(memory.processes[1], gain=15.0))) is None


def test_the_state_is_small_and_comes_back():
    memory = ValveMemory()
    for k in range(400):
        begin = START + k * DAY + 1.5
        memory = remember(
            memory, said(0.6 + 0.3 * (k % 2), s=2 + k / 300, gain=1 + k / 777), begin, begin + HOUR
        )
    text = to_state(memory)
    assert len(text) <= 10_000
    assert len(memory.processes) == PROCESSES
    back = from_state(text)
    assert back.until == memory.until
    assert back.counts == pytest.approx(memory.counts, rel=1e-5)
    hints, hints_back = (hints_from(each, LoopHints()) for each in (memory, back))
    assert hints_back.known.gain == pytest.approx(hints.known.gain, rel=1e-5)
    assert hints_back.known_valve.s == pytest.approx(hints.known_valve.s, rel=1e-5)
    assert [each.s for each in back.s_days] == pytest.approx([each.s for each in memory.s_days], rel=1e-5)
    assert to_state(back) == text


def test_a_state_of_another_version_is_read_as_far_as_it_is_understood():
    content = json.loads(to_state(remember(ValveMemory(), said(0.9), START, START + HOUR)))
    content["outcomes"] = ["rings", *content["outcomes"][:-1]]
    content["former"] = [9.0, *content["former"][:-1]]
    content["today"] = [9.0, *content["today"][:-1]]
    assert from_state(json.dumps(content)).windows == 1.0
    with pytest.raises(ValueError, match="version 99"):
        from_state(json.dumps(content | {"version": 99}))
    for damaged in ("{}", "[]", "nothing", json.dumps(content | {"until": "soon"})):
        with pytest.raises(ValueError, match=r"."):
            from_state(damaged)


def test_a_valve_that_other_windows_accuse_is_suspected_and_no_more():
    memory = ValveMemory()
    for k in range(4):
        memory = remember(memory, said(0.985), START + k * DAY, START + k * DAY + HOUR)
    newest = with_memory(said(0.1, verdict="no_stiction"), memory)
    assert newest.sticks.probability > 0.5
    assert newest.verdict == "no_stiction"
    assert is_suspected(newest)
    assert group_of(newest) == "suspected"
    assert not is_suspected(with_memory(said(0.985, verdict="stiction"), memory))


def test_a_diagnosis_alone_carries_the_probability_at_the_base_rate():
    alone = judged(WINDOW, STICKING)
    assert alone.sticks == sticks_of([alone])
    assert alone.sticks.windows == 1


def quiet_as(log_ratio):
    """A quiet window, with how its valve agrees with an S of 3."""
    return replace(said(0.5), quantification=None, weighed=None, as_before=AsBefore(3.0, log_ratio))


def test_a_quiet_window_divides_s_where_the_valve_is_known():
    memory = remember(ValveMemory(), quiet_as(-9.0), START, START + HOUR)
    (day,) = memory.s_days
    assert day.divided(recognised=True) == pytest.approx((1.5, TRUST * -9.0))
    assert day.divided(recognised=False)[1] == 0.0
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
    recognised = [each.divided(recognised=True) for each in found]
    assert recognised == [pytest.approx((0.44, -MOST)), pytest.approx((1.5, MOST_FOR))]
    not_recognised = [each.divided(recognised=False) for each in found]
    assert not_recognised == [pytest.approx((0.44, math.log(WRONG)))] * 2


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
    assert to_state(from_state(json.dumps(content))) == to_state(memory)


def test_a_state_of_the_second_version_keeps_what_divided_s():
    memory = remember(ValveMemory(), said(0.2, s=1.0), START, START + DAY)
    content = json.loads(to_state(memory)) | {"version": 2, "checks": [40.0]}
    (bound,) = content["s_days"]
    content["s_days"] = [bound[:5], [START + DAY, 1.5 / 1.04, 0.02 * 1.5 / 1.04, 1.0, -7.0]]
    read = from_state(json.dumps(content)).s_days
    assert (read[0].bound, read[0].above) == pytest.approx((1.1, math.log(WRONG)), rel=1e-4)
    assert read[1].divided(recognised=True) == pytest.approx((1.5, -7.0))
    assert read[1].divided(recognised=False)[1] == 0.0


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
