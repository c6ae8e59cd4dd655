"""What every member of QUANTIFIERS promises: agent/checks/quantifiers.py."""

import numpy as np
import pytest

from agent.analysis.quantify import QUANTIFIERS, quantifier
from agent.analysis.record.recording import LoopWindow
from agent.checks import checks_of

EACH = pytest.mark.parametrize("member", QUANTIFIERS, ids=lambda member: member.name)


SEARCHES_LONG = {
    "free_run": {"hints_that_do_not_fit", "no_valve_explains_it", "single_lost_samples", "long_record"},
    "population": {"no_valve_explains_it", "long_record"},
}
"""Checks where a quantifier searches for 5 s and more; in `make bench` for it, here for all others."""


def items():
    """All checks of a member in a row: they share its answers."""
    for member in QUANTIFIERS:
        for check in checks_of("quantifiers"):
            long = check.name in SEARCHES_LONG.get(member.name, ())
            marks = pytest.mark.bench if long else pytest.mark.slow
            yield pytest.param(member, check, id=f"{check.name}-{member.name}", marks=marks)


@pytest.mark.parametrize(("member", "check"), [*items()])
@pytest.mark.timeout(400)
def test_contract(member, check):
    check(member)


@EACH
def test_it_is_found_by_name(member):
    assert quantifier(member.name) is member


def test_infinity_reaches_no_quantifier():
    window = LoopWindow("x", 0.0, 1.0, np.array([1.0, np.inf, 3.0]), np.array([-np.inf, 2.0, 3.0]))
    np.testing.assert_array_equal(window.op, [1.0, np.nan, 3.0])
    np.testing.assert_array_equal(window.pv, [np.nan, 2.0, 3.0])
