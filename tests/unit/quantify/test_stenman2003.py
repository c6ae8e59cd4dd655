import numpy as np
import pytest

from agent.analysis.quantify import quantifier
from agent.analysis.quantify.stenman2003 import force_at_jumps
from agent.physics.valves.he2007 import he2007
from tests.unit.quantify.loops import loop, swinging_op


@pytest.mark.parametrize(("f_s", "f_d"), [(4.0, 0.0), (5.0, 0.0)])
@pytest.mark.parametrize("name", ["stenman2003", "srinivasan2005"])
def test_a_valve_of_one_parameter_comes_back(name, f_s, f_d):
    window = loop(swinging_op(), f_s, f_d)
    found = quantifier(name).quantify(window)
    assert found.decision == "stiction"
    assert found.stiction.s.value == pytest.approx(f_s, abs=0.03 * window.op_span)
    assert found.stiction.f_d.value == 0.0


def test_the_force_at_turns_is_s_of_a_valve_with_kinetic_friction():
    op = 10 * np.sin(np.arange(2000) / 50)
    stem = he2007(op, 6.0, 2.0, op[0])
    seen_as = np.where(np.diff(stem, prepend=stem[0]) != 0, op, np.nan)  # Stenman's valve jumps all the way
    for t in range(1, len(op)):
        if np.isnan(seen_as[t]):
            seen_as[t] = seen_as[t - 1]
    known = np.isfinite(seen_as)
    assert force_at_jumps(op[known], seen_as[known]) == pytest.approx(8.0, abs=0.3)


def test_a_valve_that_never_turns_shows_no_force():
    assert force_at_jumps(np.arange(10.0), np.zeros(10)) == 0.0
