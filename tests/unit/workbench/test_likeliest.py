"""Which effects make the record far less likely than others do."""

import pytest

from agent.workbench.evidence import Evidence
from agent.workbench.likeliest import less_likely, likelier_otherwise
from agent.workbench.residual.very_strong import VERY_STRONG


def evidence(criterion, family="valve", *, answers=True, once=False, explains=True):
    return Evidence(explains, 1e-6, criterion, family, answers, once)


def test_the_likelier_of_two_stays_and_equals_stay_both():
    assert less_likely({"a": 50.0, "b": 49.0 - VERY_STRONG}) == ["b"]
    assert less_likely({"a": 50.0, "b": 50.0}) == []
    assert less_likely({}) == []


def test_what_is_far_less_likely_than_another_family_is_excluded():
    found = {"lag": evidence(500.0, "lag"), "slack": evidence(190.0), "stop": evidence(491.0, "stop")}
    assert likelier_otherwise(found) == {"slack"}


@pytest.mark.parametrize(
    "other",
    [
        evidence(500.0),
        evidence(500.0, "load", answers=False),
        evidence(500.0, "gain", once=True),
        evidence(500.0, "lag", explains=False),
    ],
    ids=["its own family", "what knows nothing of OP", "what happened once", "what explains no more"],
)
def test_it_is_not_excluded_by(other):
    assert likelier_otherwise({"slack": evidence(190.0), "other": other}) == set()


def test_a_wave_is_never_excluded():
    found = {"wave": evidence(-5.0, "wave", answers=False), "slack": evidence(190.0)}
    assert likelier_otherwise(found) == set()
