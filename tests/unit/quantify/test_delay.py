import numpy as np
import pytest

from agent.analysis.loop.delay import estimate_delay
from agent.physics.valves.he2007 import he2007
from tests.unit.quantify.loops import FIRST_ORDER, SECOND_ORDER, loop, swinging_op


@pytest.mark.parametrize(("process", "order"), [(FIRST_ORDER, 1), (SECOND_ORDER, 2)])
def test_it_is_right_within_a_sample_on_the_position_of_the_valve(process, order):
    op = swinging_op()
    window = loop(op, 4.0, 1.0, process, noise=0.0)
    assert abs(estimate_delay(he2007(op, 4.0, 1.0, op[0]), window.pv, order=order, longest=60) - 4) <= 1


def test_a_missing_sample_takes_only_its_own_products_away():
    op = swinging_op()
    pv = np.roll(op, 7)
    op[100:120] = np.nan
    assert estimate_delay(op, pv, order=1, longest=60) == 7


@pytest.mark.parametrize("y", [np.full(50, 3.0), np.full(50, np.nan)])
def test_nothing_correlates_with_a_dead_signal(y):
    assert estimate_delay(swinging_op(50), y, order=1, longest=20) is None


def test_a_record_too_short_for_any_lag_has_no_delay():
    assert estimate_delay(np.arange(2.0), np.arange(2.0), order=1, longest=20) is None
