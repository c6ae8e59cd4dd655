"""Laboratory rigs do what their equations say."""

from __future__ import annotations

import numpy as np
import pytest

from simulators.balances.laboratory_rigs import LABORATORY_RIGS, laboratory_rig


@pytest.mark.parametrize("name", LABORATORY_RIGS)
def test_a_seed_is_one_record(name) -> None:
    one, same, other = (laboratory_rig(seed, name) for seed in (5, 5, 6))
    assert np.array_equal(one.pv, same.pv)
    assert not np.array_equal(one.pv, other.pv)
    assert np.isfinite(one.pv).all()
    assert one.pv.std() > 0.0 < one.op.std()


def test_the_mean_of_a_ball_follows_the_beam() -> None:
    """Its acceleration is the angle's, 5/7 g 0.4 sin."""
    ball = laboratory_rig(5, "ball")
    smooth = np.convolve(ball.pv, np.ones(9) / 9, mode="same")[20:-20]
    acceleration = np.gradient(np.gradient(smooth, ball.ts), ball.ts)
    lifted = np.convolve(ball.op, np.ones(9) / 9, mode="same")[20:-20]
    slope = np.polyfit(lifted, acceleration, 1)[0]
    assert slope == pytest.approx(5 / 7 * 9.81 * 0.4, rel=0.25)


def test_a_sensor_without_direction_shows_no_speed_below_nothing() -> None:
    assert laboratory_rig(5, "drives").pv.min() > -0.06


def test_a_converter_has_steps() -> None:
    steps = laboratory_rig(5, "coarse_heater").pv / 0.32
    assert steps == pytest.approx(np.round(steps), abs=1e-9)


def test_a_relay_has_two_levels() -> None:
    rig = laboratory_rig(5, "thermostat")
    assert set(rig.op) == {0.0, 100.0}
    assert 35.0 < np.median(rig.pv) < 75.0
