import numpy as np
import pytest

from agent.analysis.quantify.choudhury2008 import Choudhury2008, coarse_then_fine
from agent.physics.valves.two_state import two_state
from tests.unit.quantify.loops import FIRST_ORDER, SECOND_ORDER, loop, swinging_op
from tests.unit.quantify.test_bounded_search import bowl

OP = swinging_op()


@pytest.mark.parametrize("process", [FIRST_ORDER, SECOND_ORDER])
@pytest.mark.parametrize(("s", "j"), [(5.0, 3.0), (10.0, 0.0), (6.0, 6.0)])
def test_the_s_and_j_of_its_own_valve_come_back(process, s, j):
    window = loop(OP, (s + j) / 2, (s - j) / 2, process, valve=two_state)
    found = Choudhury2008().quantify(window)
    assert found.decision == "stiction"
    assert found.stiction.s.value == pytest.approx(s, abs=0.03 * window.op_span)
    assert found.stiction.j.value == pytest.approx(j, abs=0.03 * window.op_span)


@pytest.mark.parametrize("bands", [(7.3, 2.1), (5.0, 5.0), (13.7, 0.0), (20.0, 0.0), (0.0, 0.0)])
def test_the_grids_find_a_minimum_finer_than_the_coarse_one(bands):
    np.testing.assert_allclose(coarse_then_fine(bowl(*bands), 20.0), bands, atol=0.5 / 8)


def test_where_nothing_fits_the_answer_is_no_stiction():
    def nothing(bands):
        return np.full(len(bands), np.inf)

    assert coarse_then_fine(nothing, 20.0).tolist() == [0.0, 0.0]


def test_a_needle_beside_a_wide_valley_is_found_through_its_own_coarse_minimum():
    needle = np.array([4.05, 1.0])

    def errors(bands):
        return np.minimum(1.0 + bowl(9.0, 9.0)(bands), 2 * np.abs(bands - needle).sum(axis=1) + 0.9)

    np.testing.assert_allclose(coarse_then_fine(errors, 20.0), needle, atol=0.1)
