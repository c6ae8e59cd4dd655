"""Recordings of one valve: what they say together, whom it moves, and whom it must not move."""

from dataclasses import replace
from itertools import permutations

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from agent.analysis.diagnose import diagnose
from agent.analysis.evidence.together import SEARCH, joined, majority, weigh_together
from agent.analysis.evidence.weighing import SURE
from agent.analysis.memory.sticks import LIKELY
from agent.analysis.memory.weighing_windows import BASE_RATE
from agent.analysis.one_valve import judged_together
from agent.analysis.record.recording import LoopWindow
from agent.analysis.response.no_response import NoResponse
from agent.analysis.results import MethodResult, Quantification, StictionEstimate
from agent.report.advice import advice
from agent.report.reasons import reasons
from agent.units import FrictionBands

N = 300
LITTLE = Quantification(
    quantifier="free_run",
    stiction=StictionEstimate.of(FrictionBands(2.0, 1.0)),
    process=None,
    free_run_percent=70.0,
    linear_percent=60.0,
    evidence=1.5,
    decision="undecided",
    quick_evidence=1.2,
    turns=1,
    log_likelihood_ratio=15.0,
)
"""What one slip leaves: nothing to decide on."""
NOTHING = replace(LITTLE, evidence=1.0, quick_evidence=1.0, turns=0, log_likelihood_ratio=0.0)
SOUND = replace(NOTHING, stiction=None, decision="no_stiction")
STICKS = replace(LITTLE, evidence=9.0, quick_evidence=9.0, turns=20, log_likelihood_ratio=300.0)
SAYS, DENIES = MethodResult("stiction", 1.0), MethodResult("no_stiction", 0.0)


class Told:
    name = "free_run"

    def __init__(self, answer):
        self.answer = answer

    def quantify(self, _window):
        return self.answer


def day(seed, *, still=False):
    op, pv = np.random.default_rng(seed).normal(size=(2, N)).cumsum(axis=1)
    return LoopWindow(f"FIC101_{seed}", 0.0, 1.0, op=np.full(N, 42.0) if still else op, pv=pv)


def alone(answers, windows=None):
    windows = windows or [day(seed) for seed in range(len(answers))]
    said = [diagnose(each, quantifier=Told(answer)) for each, answer in zip(windows, answers, strict=True)]
    return windows, said


def together(answers, windows=None):
    return judged_together(*alone(answers, windows))


def verdicts(diagnoses):
    return [each.verdict for each in diagnoses]


def test_little_is_enough_where_all_say_it():
    windows, said = alone([LITTLE] * 4)
    assert verdicts(said) == ["undecided"] * 4
    told = judged_together(windows, said)
    assert verdicts(told) == ["stiction"] * 4
    first = told[0]
    assert first.confidence >= SURE
    assert first.confidence == told[3].confidence
    assert (first.cause, first.stiction_class) == ("stiction", "dead_band_stick_slip")
    assert reasons(first)[0].startswith("this recording alone is undecided (probability 0.")
    assert "with the 3 other recordings of this valve" in reasons(first)[0]
    assert any("the valve shows" in reason for reason in reasons(first))
    assert not any("too large to exclude" in reason for reason in reasons(first))
    assert any("packing" in step for step in advice(first))


def test_what_has_no_amount_is_not_blamed():
    told = together([LITTLE, LITTLE, LITTLE, LITTLE, replace(LITTLE, stiction=None)])
    assert verdicts(told) == ["stiction"] * 4 + ["undecided"]


def test_nothing_in_many_recordings_is_nothing():
    assert "stiction" not in verdicts(together([NOTHING] * 8))


def test_what_a_search_finds_by_chance_does_not_add_up():
    chance = replace(NOTHING, log_likelihood_ratio=SEARCH)
    assert joined([chance] * 50).log_likelihood_ratio == pytest.approx(SEARCH)
    assert "stiction" not in verdicts(together([chance] * 8))


def test_one_recording_is_as_it_was():
    windows, said = alone([LITTLE])
    assert judged_together(windows, said) == tuple(said)
    assert judged_together([], []) == ()


def test_a_recording_alone_weighs_as_in_its_diagnosis():
    (said,) = alone([STICKS])[1]
    assert weigh_together([said], stem_measured=False).probability == pytest.approx(said.confidence)


def test_not_testable_stays_and_does_not_count():
    windows = [day(0, still=True), day(1), day(2, still=True)]
    told = together([LITTLE] * 3, windows)
    assert verdicts(told) == ["not_testable", "undecided", "not_testable"]
    assert [reasons(each) for each in told] == [reasons(each) for each in alone([LITTLE] * 3, windows)[1]]


def test_a_failed_search_does_not_count():
    windows, said = alone([LITTLE, replace(LITTLE, failure="the search did not converge")])
    told = judged_together(windows, said)
    assert [replace(each, sticks=None) for each in told] == [replace(each, sticks=None) for each in said]
    assert [each.sticks for each in told] == [said[0].sticks] * 2  # of the valve, so of both


def test_the_probability_of_the_valve_is_that_of_all_its_events():
    told = together([LITTLE] * 4)
    alone_said = alone([LITTLE])[1][0]
    assert told[0].sticks.windows == 4
    assert {each.sticks for each in told} == {told[0].sticks}
    assert told[0].sticks.probability > LIKELY > alone_said.sticks.probability


def test_quiet_recordings_do_not_outweigh_slips_in_the_probability_alone():
    """Each recording in which nothing happens speaks against stiction; all are one record."""
    told = together([LITTLE] * 5 + [NOTHING] * 3)
    assert told[0].verdict == "stiction"
    assert told[0].sticks.probability > LIKELY


@settings(max_examples=30, deadline=None)
@given(st.lists(st.tuples(st.floats(0, 40), st.floats(1, 3), st.integers(0, 4)), min_size=2, max_size=6))
@example([(26.0, 1.0, 0), (26.0, 1.0, 0)])  # suspected by each event, not enough as one record
def test_the_probability_never_contradicts_the_verdict_of_all(told):
    answers = [
        replace(LITTLE, log_likelihood_ratio=ratio, evidence=evidence, quick_evidence=evidence, turns=turns)
        for ratio, evidence, turns in told
    ]
    for each in together(answers):
        if each.others.together >= SURE:
            assert each.sticks.probability > LIKELY
        if each.others.together <= 1 - SURE:
            assert each.sticks.probability < BASE_RATE


def test_a_valve_that_pv_does_not_show_is_not_cleared_by_other_recordings():
    windows, said = alone([replace(SOUND, log_likelihood_ratio=12.0), SOUND, SOUND, SOUND])
    assert judged_together(windows, said)[0].verdict == "no_stiction"
    said[0] = replace(said[0], no_response=NoResponse("unknown", 0, N, 50.0, 9.0, 0.09, 3.0, 90.0, 0.95))
    assert judged_together(windows, said)[0].verdict == "undecided"


def test_another_quantifier_has_no_evidence_to_share():
    windows, said = alone([replace(LITTLE, quick_evidence=None)] * 4)
    assert judged_together(windows, said) == tuple(said)


def test_firm_verdicts_stay_and_are_reported_of_the_contrary():
    told = together([LITTLE] * 6 + [SOUND])
    assert verdicts(told) == ["stiction"] * 6 + ["no_stiction"]
    assert "verdict of this recording stays" in reasons(told[-1])[0]
    assert told[-1].confidence == alone([LITTLE] * 6 + [SOUND])[1][-1].confidence
    told = together([STICKS, *[SOUND] * 60])
    assert told[0].verdict == "stiction"
    assert set(verdicts(told[1:])) == {"no_stiction"}
    assert "verdict of this recording stays" in reasons(told[0])[0]


def test_undecided_is_cleared_only_where_free_run_clears_it():
    unsure = replace(SOUND, log_likelihood_ratio=12.0)
    denied = replace(unsure, decision="undecided", stiction=LITTLE.stiction)
    windows, said = alone([unsure, denied, SOUND, SOUND, SOUND])
    assert verdicts(said)[:2] == ["undecided"] * 2
    assert verdicts(judged_together(windows, said))[:2] == ["no_stiction", "undecided"]


def test_of_several_recordings_that_which_shows_most_counts():
    unsure, hides = replace(SOUND, log_likelihood_ratio=12.0), replace(SOUND, would_show=0.1)
    windows, said = alone([replace(unsure, would_show=0.1), hides, hides, hides])
    shown = replace(said[1], quantification=replace(hides, would_show=1.0))
    less, more = (judged_together(windows, [*said[:3], last])[0].confidence for last in (said[3], shown))
    assert 0.5 < less < more


def test_one_event_counts_once():
    window = day(0)
    again = replace(window, loop="FIC101_9", start=77.0)
    told = together([LITTLE] * 4, [window, again, day(1), day(2)])
    three = together([LITTLE] * 3, [window, day(1), day(2)])
    assert reasons(told[0])[0] == reasons(three[0])[0]
    assert [sum("count as one" in reason for reason in reasons(each)) for each in told] == [
        0,
        1,
        0,
        0,
    ]
    assert "same event as FIC101_0" in reasons(told[1])[-1]


def test_one_event_alone_is_no_second_witness():
    window = day(0)
    told = together([LITTLE] * 2, [window, replace(window, loop="FIC101_9")])
    assert verdicts(told) == ["undecided"] * 2
    assert "count as one" in reasons(told[1])[-1]


def test_order_does_not_matter():
    windows, said = alone([LITTLE, SOUND, STICKS, replace(LITTLE, log_likelihood_ratio=2.0)])
    windows.append(replace(windows[0], loop="again"))
    said.append(replace(said[0], loop="again"))
    expected = {each.loop: each for each in judged_together(windows, said)}
    for order in list(permutations(range(5)))[::7]:
        told = judged_together([windows[k] for k in order], [said[k] for k in order])
        assert {each.loop: (each.verdict, reasons(each)) for each in told} == {
            name: (each.verdict, reasons(each)) for name, each in expected.items()
        }


def test_detectors_go_by_majority():
    found = majority([{"a": SAYS, "b": SAYS}, {"a": SAYS, "b": DENIES}, {"a": DENIES}])
    assert (found["a"].verdict, found["b"].verdict) == ("stiction", "undecided")


@settings(max_examples=200, deadline=None)
@given(
    st.lists(
        st.tuples(
            st.floats(0, 1e6) | st.none(), st.integers(0, 10**6) | st.none(), st.floats(0, 1e9) | st.none()
        ),
        min_size=1,
        max_size=8,
    )
)
def test_joined_answers_are_sound_numbers(told):
    found = joined(
        [
            replace(
                LITTLE, evidence=evidence, quick_evidence=evidence, turns=turns, log_likelihood_ratio=ratio
            )
            for evidence, turns, ratio in told
        ]
    )
    assert 1.0 <= found.evidence <= np.e + 1e-9
    assert found.log_likelihood_ratio >= 0
    assert found.turns >= 0
