"""What a process effect makes of a linear process; the sums of steps are in tests/reference."""

import numpy as np
import pytest

from agent.physics.bases.linear_process import LinearProcess, lagged

STEP = np.where(np.arange(200) < 20, 0.0, 1.0)


def test_a_lag_shorter_than_a_hundredth_of_a_sample_is_none():
    plain = LinearProcess(6.0, (10.0,)).respond(STEP, 2.0)
    np.testing.assert_array_equal(LinearProcess(6.0, (10.0, 0.0)).respond(STEP, 2.0), plain)
    np.testing.assert_allclose(LinearProcess(6.0, (10.0, 0.03)).respond(STEP, 2.0), plain, atol=0.02)


def test_without_any_lag_only_time_passes():
    np.testing.assert_array_equal(LinearProcess(6.0).respond(STEP, 2.0)[3:], STEP[:-3])


def test_the_order_of_lags_does_not_matter():
    one, other = (LinearProcess(3.0, lags).respond(STEP, 1.0) for lags in ((9.0, 2.0, 5.0), (2.0, 5.0, 9.0)))
    np.testing.assert_array_equal(one, other)


def test_inverse_response_falls_by_lead_over_lag_first():
    response = LinearProcess(1.0, (10.0,), lead=4.0).respond(STEP, 0.01)
    assert response.min() == pytest.approx(-0.4, abs=2e-3)


def test_creep_of_one_over_the_lag_makes_an_integrator():
    """(1 + s tau) / (s tau) behind 1 / (1 + s tau)."""
    op = np.sin(np.arange(400) / 15.0)
    lag = 8.0
    creeping = LinearProcess(3.0, (lag,), creep=1 / lag).respond(op, 1.0)
    integral = LinearProcess(3.0, integrates=True).respond(op, 1.0) / lag
    ramps = np.vander(np.arange(400.0), 2)
    left = creeping - integral
    left -= ramps @ np.linalg.lstsq(ramps, left, rcond=None)[0]
    assert np.std(left) < 0.01 * np.std(creeping)


def test_lagged_answers_a_ramp_by_a_ramp_that_is_late_by_the_lag():
    late = lagged(np.arange(100.0), 4.0)
    assert late[-1] == pytest.approx(99 - 4)
    assert late[0] == 0.0
