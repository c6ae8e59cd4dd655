"""What the innovations say of effects beside each other."""

import math

import pytest

from agent.workbench.evidence import Evidence
from agent.workbench.likeliest import is_strong, less_likely, outdone, plain
from agent.workbench.residual.very_strong import VERY_STRONG

COUNT = 16
PRIOR = 2 * math.log(COUNT)


def told(criterion, family="valve", *, answers=True, once=False, by_chance=1e-6, more=True):
    return Evidence(more, by_chance, criterion, family, answers, once)


def padded(**found):
    """The same among ``COUNT`` candidates, the others as unlikely as what is not there."""
    return found | {f"decoy {i}": told(-20.0, f"family {i}", more=False) for i in range(COUNT - len(found))}


def test_the_likelier_of_two_stays_and_equals_stay_both():
    assert less_likely({"a": 50.0, "b": 49.0 - VERY_STRONG}) == ["b"]
    assert less_likely({"a": 50.0, "b": 50.0}) == []
    assert less_likely({}) == []


def test_another_family_outdoes_what_is_far_less_likely():
    found = {"lag": told(500.0, "lag"), "slack": told(190.0), "stop": told(491.0, "stop")}
    assert outdone(found) == {"slack"}


@pytest.mark.parametrize(
    "other",
    [
        told(500.0),
        told(500.0, "load", answers=False),
        told(500.0, "gain", once=True),
        told(500.0, "lag", more=False),
    ],
    ids=["its own family", "what knows nothing of OP", "what happened once", "what tells no more"],
)
def test_it_is_not_outdone_by(other):
    assert outdone({"slack": told(190.0), "other": other}) == set()


def test_a_wave_is_never_outdone():
    assert outdone({"wave": told(-5.0, "wave", answers=False), "slack": told(190.0)}) == set()


def test_what_is_far_ahead_of_all_others_is_plain():
    alike = {"slack": told(60.0), "stiction": told(58.0)}
    assert plain(padded(**alike)) == {"slack", "stiction"}
    assert plain(padded(**alike, stop=told(51.0, "stop"))) == set()
    assert plain(padded(**alike, step=told(51.0, "load", answers=False, once=True))) == set()
    assert plain(padded(**alike, wave=told(70.0, "wave", answers=False))) == {"slack", "stiction"}


def test_what_may_be_chance_or_is_not_strong_is_not_plain():
    assert plain(padded(slack=told(60.0, by_chance=0.06))) == set()
    assert plain(padded(slack=told(VERY_STRONG + PRIOR - 0.1))) == set()
    assert plain(padded(gain=told(60.0, "gain", once=True))) == set()


def test_of_more_candidates_more_is_requested():
    evidence = told(VERY_STRONG + PRIOR + 0.1)
    assert is_strong([evidence], COUNT)
    assert not is_strong([evidence], 2 * COUNT)
    assert is_strong([told(-5.0), evidence], COUNT)
    assert is_strong([told(-5.0, answers=False)], COUNT)
