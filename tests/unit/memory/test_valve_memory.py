"""What is remembered of a valve: no window twice, days as one, forgetting, the cap, the state as text."""

import json
import math
from dataclasses import replace

import pytest

from agent.analysis.evidence.weighing import SURE, Weighed
from agent.analysis.memory.known import known_from
from agent.analysis.memory.outcome import EDGES, OUTCOMES, outcome_of
from agent.analysis.memory.rates import HIDDEN, MIMICS
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
from agent.analysis.memory.weighing_windows import log_likelihoods, probability_of
from agent.analysis.record.recording import LoopHints
from agent.analysis.response.no_response import NoResponse
from agent.report.ranking import group_of
from tests.unit.analysis.diagnoses import STICKING, WINDOW, judged
from tests.unit.memory.windows import HOUR, START, said


def log_bayes_factor(counts):
    if_sticks, if_sound = log_likelihoods(counts)
    return if_sticks - if_sound


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


@pytest.mark.parametrize(
    ("cause", "verdict", "outcome"),
    [
        ("unknown", "undecided", None),
        ("unknown", "stiction", "strong"),
        ("no_flow", "undecided", None),
        ("stuck_valve", "undecided", "stuck"),
    ],
)
def test_a_pv_that_does_not_respond_counts_as_its_cause_is_known(cause, verdict, outcome):
    found = NoResponse(cause, 0, 300, 50.0, 8.0, 0.08, 12.0, 60.0, 0.99)
    assert outcome_of(replace(said(0.95, verdict=verdict), no_response=found)) == outcome


def test_quiet_windows_leave_the_probability_as_it_is():
    memory = ValveMemory()
    for k in range(50):
        quiet = replace(said(0.5), verdict="no_stiction", weighed=None)
        memory = remember(memory, quiet, START + k * DAY, START + k * DAY + HOUR)
    assert memory.probability() == pytest.approx(0.2)


NOTHING_FOUND = {"log_likelihood_ratio": 0.0, "evidence": 1.0, "quick_evidence": 1.0, "turns": 0}


def against(would_show):
    """A window in which no valve that sticks was found, though it would have shown one so likely."""
    found = replace(STICKING, decision="undecided", would_show=would_show, **NOTHING_FOUND)
    return replace(judged(WINDOW, found), methods={}, no_response=None)


def test_nothing_found_counts_as_far_as_the_window_would_have_shown_it():
    assert outcome_of(against(1.0)) == "against"
    found = [sticks_of([against(would_show)] * 5).probability for would_show in (0.0, 0.1, 0.5, 1.0)]
    assert found[0] == pytest.approx(0.2)
    assert found == sorted(found, reverse=True)
    assert sticks_of([against(None)] * 5).probability == found[-1]


def test_a_slip_is_not_outweighed_by_windows_that_would_not_have_shown_it():
    slip = said(0.985)
    assert sticks_of([*[against(0.02)] * 6, slip]).probability > LIKELY
    assert sticks_of([*[against(1.0)] * 6, slip]).probability < LIKELY


def test_the_memory_counts_windows_as_records_are_counted():
    memory = ValveMemory()
    for k in range(3):
        start = START + k * DAY
        memory = remember(memory, against(0.3), start, start + HOUR)
    assert memory.windows == pytest.approx(0.9, rel=0.05)
    assert sticks_of([against(0.3)] * 3).windows == pytest.approx(0.9)


def test_what_is_enough_for_the_verdict_is_more_likely_than_not():
    assert sticks_of([replace(said(0.9), weighed=Weighed(SURE, ()))]).probability > LIKELY


def test_without_evidence_the_probability_is_the_base_rate():
    assert ValveMemory().probability() == pytest.approx(0.2)
    assert ValveMemory().probability(0.35) == pytest.approx(0.35)


@pytest.mark.parametrize("outcome", OUTCOMES)
def test_many_windows_do_not_add_up_to_certainty(outcome):
    """The odds rise by no more than the part of the sound valves that look like sticking ones allows.

    And they fall by no more than the part of the sticking ones that look sound allows.
    """
    many = [log_bayes_factor(counts(**{outcome: n})) for n in (1, 10, 100, 1000, 10000)]
    assert max(many) <= math.log((1 - HIDDEN) / MIMICS) + 1e-9
    assert min(many) >= math.log(HIDDEN / (1 - MIMICS)) - 1e-9
    assert log_bayes_factor(counts(very_strong=1000)) == pytest.approx(
        math.log((1 - HIDDEN) / MIMICS), abs=0.001
    )
    assert log_bayes_factor(counts(against=1000)) == pytest.approx(math.log(HIDDEN / (1 - MIMICS)), abs=0.2)


def test_contrary_windows_bring_the_odds_back():
    assert probability_of(counts(very_strong=5, against=5)) < probability_of(counts(very_strong=5))
    assert probability_of(counts(against=30, very_strong=1)) < probability_of(counts(very_strong=1)) / 2


def test_windows_that_agree_hardly_are_evidence_where_sound_valves_have_none():
    """Ten of 20 windows ``fair`` and four ``strong``, as no sound valve of 60 has (92169 had P = 0.17)."""
    assert probability_of(counts(against=3, weak=4, fair=10, strong=4)) > 0.8
    assert probability_of(counts(against=15, hardly=3, fair=2)) < 0.1


def test_windows_that_look_sound_never_speak_for_stiction():
    several = (0, 1, 2, 5, 10, 100, 1000)
    odds = [log_bayes_factor(counts(against=n)) for n in several]
    assert odds == sorted(odds, reverse=True)
    assert all(log_bayes_factor(counts(hardly=n)) < 0 for n in several[1:])


def test_the_ordered_outcomes_come_before_stuck():
    assert OUTCOMES[-1] == "stuck"
    assert len(OUTCOMES) == len(EDGES) + 2


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


def weeks_of(*probabilities):
    """The memory after a window a day."""
    memory = ValveMemory()
    for k, probability in enumerate(probabilities):
        memory = remember(memory, said(probability), START + k * DAY, START + k * DAY + HOUR)
    return memory


def test_a_valve_that_begins_to_stick_is_found_within_days():
    sound = [0.05] * 60
    assert weeks_of(*sound).probability() < 0.05
    assert weeks_of(*sound, 0.985).probability() < 0.2
    assert weeks_of(*sound, 0.985, 0.985).probability() > LIKELY
    assert weeks_of(*sound, 0.95, 0.95, 0.95).probability() > LIKELY
    assert weeks_of(*sound, 0.985, 0.05, 0.05).probability() < 0.05


def test_a_valve_that_no_longer_shows_stiction_is_believed_within_days():
    assert weeks_of(*[0.985] * 30, 0.05, 0.05, 0.05).probability() < 0.2


def test_the_days_since_which_a_valve_may_be_another_add_up():
    memory = weeks_of(0.05, 0.985, 0.95)
    newest, two, all_ = memory.since
    assert sum(newest) == pytest.approx(1.0)
    assert two == pytest.approx(counts(strong=1.0, very_strong=1.0), rel=0.02)
    assert all_ == pytest.approx(memory.counts)
    assert from_state(to_state(memory)).probability() == pytest.approx(memory.probability(), rel=1e-4)


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
