import pytest

from simulators.controller import Controller
from simulators.parameters import ControllerParameters


def controller(**changes):
    parameters = {"kc": 2.0, "ti": 10.0, "sp": 100.0, "op": 50.0} | changes
    return Controller(ControllerParameters(**parameters), (0.0, 100.0), 1.0)


def test_proportional_and_integral_parts():
    pi = controller()
    # error 1: P 2, I grows by 2 * 1 / 10 a sample
    assert [pi.update(100.0, 99.0) for _ in range(3)] == pytest.approx([52.2, 52.4, 52.6])


def test_direct_acting_turns_round():
    assert controller(acting="direct").update(100.0, 99.0) == pytest.approx(47.8)


@pytest.mark.parametrize(("pv", "limit"), [(90.0, 100.0), (110.0, 0.0)])
def test_no_wind_up_at_either_limit(pv, limit):
    pi = controller(ti=5.0)
    for _ in range(500):
        op = pi.update(100.0, pv)
    assert op == limit
    back = pi.update(100.0, 200.0 - pv)  # the error turns round
    assert abs(back - limit) > 20.0
    assert abs(pi.update(100.0, 100.0) - limit) > 10.0


def test_rests_where_error_is_zero():
    pi = controller()
    assert [pi.update(100.0, 100.0) for _ in range(3)] == [50.0, 50.0, 50.0]


def test_feed_forward_cancels_its_part_of_the_load_within_the_limits():
    assert controller(feed_forward=0.8).update(100.0, 100.0, 10.0) == pytest.approx(42.0)
    assert controller(acting="direct", feed_forward=0.8).update(100.0, 100.0, 10.0) == pytest.approx(42.0)
    assert controller(feed_forward=1.0).update(100.0, 100.0, 80.0) == 0.0
    assert controller().update(100.0, 100.0, 10.0) == 50.0
