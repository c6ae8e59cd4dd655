"""Calibration errors of probabilities that are right, too low, or undefined."""

import math

import numpy as np
import pytest

from benchmarks.tables.calibration import calibration_error, error_by_chance


def drawn(count, low=0.0):
    rng = np.random.default_rng(86)
    p = rng.beta(0.5, 2.0, count)
    return p * (1 - low), rng.random(count) < p


def test_probabilities_that_are_right_have_an_error_of_chance():
    p, sticks = drawn(20_000)
    assert calibration_error(p, sticks) < 0.01
    p, sticks = drawn(60)
    assert error_by_chance(p, sticks) > 0.02


def test_probabilities_that_are_too_low_have_the_error_that_they_lack():
    p, sticks = drawn(20_000, low=0.5)
    assert calibration_error(p, sticks) == pytest.approx(0.1, abs=0.02)
    assert error_by_chance(p, sticks) < 0.03


def test_valves_of_one_kind_have_no_error():
    assert math.isnan(calibration_error([0.2, 0.3], [False, False]))
    assert math.isnan(error_by_chance([0.2, 0.3], [False, False]))
