import numpy as np
import pytest

from simulators.draws.periodicity import period_and_strength


@pytest.mark.parametrize("period", [20, 47, 150])
def test_sine_repeats_itself(period):
    found, strength = period_and_strength(np.sin(2 * np.pi * np.arange(2000) / period))
    assert found == pytest.approx(period, abs=1)
    assert strength > 0.95


def test_noise_does_not_swing():
    assert period_and_strength(np.random.default_rng(0).standard_normal(2000))[1] < 0.15


def test_constant_does_not_swing():
    assert period_and_strength(np.full(100, 3.0)) == (0.0, 0.0)
