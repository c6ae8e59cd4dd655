import numpy as np
import pytest

from agent.analysis.loop.ellipse import apparent_stiction, fit_ellipse
from tests.unit.quantify.loops import loop, swinging_op

PHASE = np.linspace(0, 40, 700)


def op_pv_wave(lag, op_amplitude=5.0, pv_amplitude=0.3):
    return 40 + op_amplitude * np.cos(PHASE), -7 + pv_amplitude * np.cos(PHASE - lag)


@pytest.mark.parametrize("lag", [1e-4, 0.3, 1.5, 2.9])
@pytest.mark.parametrize("pv_amplitude", [1e-7, 0.3, 1e6])
def test_two_sines_give_the_width_of_their_phase_lag(lag, pv_amplitude):
    op, pv = op_pv_wave(lag, pv_amplitude=pv_amplitude)
    assert apparent_stiction(op, pv) == pytest.approx(2 * 5.0 * np.sin(lag), rel=1e-4)


def test_the_points_of_an_ellipse_lie_on_the_ellipse_fitted():
    x, y = op_pv_wave(1.1)
    found = fit_ellipse(x, y)
    u, v = x - found.x0, y - found.y0
    assert (found.x0, found.y0) == (pytest.approx(40.0), pytest.approx(-7.0))
    np.testing.assert_allclose(found.a * u * u + found.b * u * v + found.c * v * v, 1.0, rtol=1e-6)


def test_noise_and_gaps_move_the_width_little():
    random = np.random.default_rng(0)
    op, pv = op_pv_wave(0.8)
    noisy = pv + 0.03 * random.standard_normal(len(pv))
    noisy[random.random(len(pv)) < 0.2] = np.nan
    assert apparent_stiction(op, noisy) == pytest.approx(apparent_stiction(op, pv), rel=0.03)


def test_the_width_is_apparent_for_a_free_valve_has_one_too():
    assert apparent_stiction(loop(swinging_op(), 0.0, 0.0).op, loop(swinging_op(), 0.0, 0.0).pv) > 10


@pytest.mark.parametrize(
    ("x", "y"),
    [
        (np.arange(9.0), 2 * np.arange(9.0)),
        (np.arange(9.0), np.full(9, 3.0)),
        (np.full(9, np.nan), np.arange(9.0)),
        (np.arange(5.0), np.array([0.0, 2.0, 1.0, 2.0, 0.0])),
        (np.array([0.0, 1.0, 2.0, 3.0, 0.0, 1.0, 2.0, 3.0]), np.array([0.0] * 4 + [1.0] * 4)),
    ],
    ids=["a line", "level", "nothing known", "five points", "two lines"],
)
def test_without_an_ellipse_there_is_no_width(x, y):
    assert fit_ellipse(x, y) is None
    assert apparent_stiction(x, y) is None
