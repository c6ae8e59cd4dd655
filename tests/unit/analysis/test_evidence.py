"""Weighing: who counts, by how much, and what cannot be."""

import math
from dataclasses import replace

import numpy as np
import pytest

from agent.analysis.evidence.weighing import MOST, SHOWN, features, sound_as_far_as_shown, weigh
from agent.analysis.evidence.weights import (
    BIAS,
    DETECTORS,
    FREE_RUN,
    FREE_RUN_QUICK,
    INNOVATIONS,
    INNOVATIONS_OVER_TURNS,
    WITH_STEM,
)
from agent.analysis.results import MethodResult, Quantification
from agent.analysis.stiction import DETECTORS as ALL

FOUND = Quantification("free_run", None, None, 90.0, 60.0, 1.0, "no_stiction", quick_evidence=1.0, turns=20)
STICKS, SLIDES = MethodResult("stiction", 1.0), MethodResult("no_stiction", 0.0)


def probability(log_odds):
    return 1 / (1 + math.exp(-log_odds))


def test_every_detector_has_a_weight_and_none_counts_against_its_own_word():
    assert set(DETECTORS) == {each.name for each in ALL}
    assert set(WITH_STEM) <= set(DETECTORS)
    fits = (FREE_RUN, FREE_RUN_QUICK, INNOVATIONS_OVER_TURNS, INNOVATIONS)
    assert min(*DETECTORS.values(), *WITH_STEM.values(), *fits) >= 0


def test_odds_multiply():
    found = weigh(FOUND, {"damarla": STICKS, "rossi_scali": SLIDES}, stem_measured=False)
    expected = BIAS + DETECTORS["damarla"] - DETECTORS["rossi_scali"]
    assert found.probability == pytest.approx(probability(expected))
    assert {each.name for each in found.witnesses} == {"damarla", "rossi_scali"}


def test_strongest_witness_comes_first():
    found = weigh(
        replace(FOUND, evidence=9.0, quick_evidence=9.0), {"yamashita": STICKS}, stem_measured=False
    )
    assert [each.name for each in found.witnesses] == ["free_run", "yamashita"]


def test_measured_stem_counts_for_more():
    said = {"kano_a": STICKS, "yamashita": STICKS}
    blind, seeing = (weigh(FOUND, said, stem_measured=stem).probability for stem in (False, True))
    assert seeing > 0.5 > blind


@pytest.mark.parametrize(
    ("evidence", "turns", "says"),
    [(1.0, 50, 0.0), (0.9, 50, 0.0), (None, None, 0.0), (9.0, 0, 0.0), (9.0, 10, 1.0), (9.0, 99, 1.0)],
)
def test_evidence_counts_over_turns(evidence, turns, says):
    found = replace(FOUND, evidence=evidence, quick_evidence=evidence, turns=turns)
    assert features(found) == pytest.approx((says, says, 0.0, 0.0))


@pytest.mark.parametrize(
    ("ratio", "turns", "says"),
    [
        (None, 50, 0.0),
        (-3.0, 50, 0.0),
        (10.0, 50, math.log(2, 11)),
        (100.0, 0, 1.0),
        (1e6, 10, 1.0),
    ],
)
def test_likelihood_counts_without_turns_and_once_more_over_them(ratio, turns, says):
    found = replace(FOUND, log_likelihood_ratio=ratio, turns=turns)
    assert features(found) == pytest.approx((0.0, 0.0, says * (turns > 0), says))


def test_nobody_is_surer_than_the_calibration():
    everyone = {each.name: STICKS for each in ALL}
    found = weigh(replace(FOUND, evidence=99.0, quick_evidence=99.0), everyone, stem_measured=True)
    assert found.probability == pytest.approx(probability(MOST))


def test_method_without_weight_adds_nothing():
    assert weigh(FOUND, {"unheard_of": STICKS}, stem_measured=False) == weigh(FOUND, {}, stem_measured=False)


def test_a_valve_is_sound_as_far_as_it_would_have_been_shown():
    found = [sound_as_far_as_shown(0.1, shown) for shown in (0.0, 0.4, SHOWN, 1.0, None)]
    assert found == sorted(found)
    assert found[2:] == pytest.approx([0.9, 0.9, 0.9])
    assert found[0] == pytest.approx(1 / (1 + (1 / 9) / (1 - SHOWN + SHOWN / 9)))


def test_of_many_valves_as_many_are_sound():
    """Half of the valves stick; those that are not shown look as the sound ones."""

    def looking_sound(shown):
        rng = np.random.default_rng(119)
        sticks, is_shown = rng.random(400_000) < 0.5, rng.random(400_000) < shown
        looks = rng.random(400_000) < np.where(sticks & is_shown, 0.02, 0.8)
        return np.mean(~sticks[looks])

    of_learnt = sound_as_far_as_shown(1 - looking_sound(SHOWN), None)
    assert of_learnt == pytest.approx(looking_sound(SHOWN))
    of_less = sound_as_far_as_shown(1 - looking_sound(SHOWN), 0.3)
    assert looking_sound(0.3) < of_less < of_learnt
