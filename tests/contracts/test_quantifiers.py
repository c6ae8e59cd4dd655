"""What every member of QUANTIFIERS promises: agent/checks/quantifiers.py."""

import numpy as np
import pytest

from agent.analysis.quantify import QUANTIFIERS, quantifier
from agent.analysis.record.recording import LoopWindow
from agent.checks import checks_of

EACH = pytest.mark.parametrize("member", QUANTIFIERS, ids=lambda member: member.name)


@EACH
@pytest.mark.parametrize("check", checks_of("quantifiers"), ids=lambda check: check.name)
@pytest.mark.slow
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
