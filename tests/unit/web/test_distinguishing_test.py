"""The test that the page proposes for effects that a record cannot distinguish is that of their family."""

from collections import Counter

from agent.physics.effects import EFFECTS
from agent.web.workbench.next_test import TESTS, distinguishing_test


def test_each_family_of_several_effects_has_its_own_test():
    members = Counter(each.family for each in EFFECTS)
    several = {family for family, count in members.items() if count > 1}
    assert set(TESTS) == several
    assert len(set(TESTS.values())) == len(TESTS)


def test_no_test_is_made_up_for_a_family_of_one_or_none():
    assert distinguishing_test("gain") is None
    assert distinguishing_test(None) is None
