"""What is decided for of several candidates, by how much likelier the record is with each."""

import math

import pytest

from agent.workbench.hypotheses import Candidate, decide
from agent.workbench.residual.very_strong import STRONG, VERY_STRONG

FAMILIES = {
    "deadband": "valve_hysteresis",
    "stiction": "valve_hysteresis",
    "sinusoid": "disturbance",
    "wave": "disturbance",
    "load_step": "disturbance",
    "decoy": "decoy",
    "FEED": "measured_input",
    "TEMP": "measured_input",
}
PRICE = 6.0
"""Of being one of several."""


def tried(effect, criterion, percent=60.0, **other):
    known = {"low": percent - 5, "high": percent + 5, "p": 1.0, "odds": criterion - PRICE} | other
    return Candidate(effect, FAMILIES[effect], percent, criterion=criterion, **known)


def wave(effect, percent, criterion=0.0, **other):
    known = {"p": 1e-3, "odds": math.inf, "by_blocks": True} | other
    return tried(effect, criterion, percent, **known)


def verdict(candidates):
    less = {each.effect: each.error_reduction_percent for each in candidates}
    return decide(candidates, lambda one, other: less[one] - less[other] > 10.0)


def decided(*candidates):
    found = verdict(candidates)
    return found.kind, found.effect, found.indistinguishable


def test_the_likeliest_is_confirmed_whatever_held_out_blocks_say():
    """The best of the free run may be the one that hides more of OP's answer to the load."""
    found = verdict([tried("deadband", 120.0, 20.0), tried("decoy", 100.0, 75.0)])
    assert (found.kind, found.effect, found.family) == ("confirmed", "deadband", "valve_hysteresis")
    assert found.indistinguishable == found.rivals == ()
    assert [each.effect for each in found.candidates] == ["decoy", "deadband"]


@pytest.mark.parametrize(
    ("ahead", "kind", "effect"),
    [
        (STRONG + 1, "confirmed", "deadband"),
        (STRONG - 1, "suggested", "deadband"),
        (1 - STRONG, "suggested", "decoy"),
        (-STRONG - 1, "confirmed", "decoy"),
    ],
)
def test_one_of_another_family_about_as_likely_is_a_rival(ahead, kind, effect):
    found = verdict([tried("deadband", 90.0), tried("decoy", 90.0 - ahead)])
    assert (found.kind, found.effect) == (kind, effect)
    other = "decoy" if effect == "deadband" else "deadband"
    assert found.rivals == found.indistinguishable == (() if kind == "confirmed" else (other,))


def test_members_of_one_family_that_are_as_likely_leave_the_simplest_and_the_subtype_open():
    both = tried("deadband", 88.0, 40.0), tried("stiction", 90.0)
    assert decided(*both) == ("family", "deadband", ("stiction",))
    assert decided(tried("deadband", 80.0, 40.0), tried("stiction", 90.0)) == ("confirmed", "stiction", ())


def test_of_one_family_what_lowers_the_error_as_much_is_as_good_the_far_likelier_first():
    assert decided(tried("deadband", 81.0), tried("stiction", 90.0)) == ("family", "deadband", ("stiction",))
    assert decided(tried("deadband", 79.0), tried("stiction", 90.0)) == ("family", "stiction", ("deadband",))


@pytest.mark.parametrize(
    ("odds", "kind"),
    [(-1.0, "none"), (1.0, "suggested"), (VERY_STRONG - 1, "suggested"), (VERY_STRONG + 1, "confirmed")],
)
def test_how_sure_an_effect_is_decides_what_is_said_of_it(odds, kind):
    found = verdict([tried("stiction", odds + PRICE)])
    assert (found.kind, found.effect) == (kind, None if kind == "none" else "stiction")


def test_an_effect_too_small_to_matter_is_none_however_likely():
    assert decided(tried("stiction", 500.0, 3.0)) == ("none", None, ())


def test_what_is_far_less_likely_is_not_named_in_place_of_what_cannot_be():
    small = tried("deadband", 120.0, 3.0)
    assert decided(small, tried("decoy", 109.0))[0] == "none"
    assert decided(small, tried("decoy", 111.0)) == ("confirmed", "decoy", ())


def test_what_a_check_rejects_excludes_nothing():
    rejected = tried("load_step", 500.0, odds=-math.inf, objection="a reason")
    assert decided(rejected, tried("decoy", 60.0)) == ("confirmed", "decoy", ())


def test_a_parameter_at_a_bound_is_no_confirmation():
    assert decided(tried("deadband", 90.0, at_bound=True)) == ("suggested", "deadband", ())


def test_of_two_alike_the_one_inside_its_bounds_is_named():
    bound = tried("deadband", 92.0, at_bound=True)
    assert decided(bound, tried("stiction", 90.0)) == ("family", "stiction", ("deadband",))


def test_a_wave_is_confirmed_by_blocks_where_no_effect_is_by_its_likelihood():
    seen = wave("sinusoid", 70.0)
    assert decided(seen) == ("confirmed", "sinusoid", ())
    assert decided(seen, tried("stiction", 90.0)) == ("confirmed", "stiction", ())
    assert decided(seen, tried("load_step", 90.0, 40.0, once=True)) == ("confirmed", "sinusoid", ())
    assert decided(seen, tried("load_step", 90.0, once=True)) == ("confirmed", "load_step", ())
    assert decided(seen, tried("stiction", PRICE + 1)) == ("confirmed", "sinusoid", ())
    assert decided(seen, wave("wave", 66.0)) == ("family", "sinusoid", ("wave",))
    assert decided(seen, wave("wave", 40.0)) == ("confirmed", "sinusoid", ())


@pytest.mark.parametrize(
    "other",
    [{"p": 0.06}, {"low": -1.0}, {"objection": "no line"}, {"percent": 4.0}],
    ids=lambda each: next(iter(each)),
)
def test_a_wave_that_blocks_do_not_show_is_none(other):
    assert decided(wave("sinusoid", **({"percent": 40.0} | other)))[0] == "none"


def test_a_wave_that_slow_noise_may_have_made_is_suggested_where_nothing_else_is():
    slow = wave("sinusoid", 40.0, odds=0.0)
    assert decided(slow) == ("suggested", "sinusoid", ())
    assert decided(slow, tried("stiction", PRICE + 1)) == ("suggested", "stiction", ())


def test_of_measured_inputs_the_likeliest_is_named_in_whatever_order_they_were_given():
    feed, temp = tried("FEED", 88.0), tried("TEMP", 90.0)
    assert decided(feed, temp) == decided(temp, feed) == ("family", "TEMP", ("FEED",))


def test_no_candidates_is_none():
    assert decided() == ("none", None, ())


@pytest.mark.parametrize(("ahead", "effect"), [(VERY_STRONG + 1, "wave"), (VERY_STRONG - 1, "deadband")])
def test_a_wave_that_makes_the_record_far_likelier_is_named_before_what_is_plain(ahead, effect):
    plain = tried("deadband", 50.0, 42.0)
    assert decided(plain, wave("wave", 80.0, criterion=50.0 + ahead))[:2] == ("confirmed", effect)
