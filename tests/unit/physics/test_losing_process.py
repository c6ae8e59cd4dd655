"""A vessel whose losses bend, behind dead time and further lags."""

from dataclasses import replace

import numpy as np
import pytest

from agent.physics.bases.linear_process import LinearProcess
from agent.physics.bases.losing_process import LosingProcess
from agent.physics.effect import Facts
from agent.physics.effects.loss_curve import LossCurve
from simulators.parts.first_order import heated

STEPS = np.repeat([50.0, 60.0, 45.0, 55.0, 40.0], 200)
TAU, FINE = 20.0, 50


def losing(curvature, **others):
    return LosingProcess(3.0, (TAU,), curvature=curvature, level=50.0, **others)


def test_without_curvature_it_is_the_process_of_the_base():
    process = LinearProcess(3.0, (TAU,))
    assert LossCurve().change(process, np.array([0.0, 50.0])) is process
    for others in ({}, {"lead": 6.0}, {"creep": 0.001}, {"lags": (TAU, 7.0)}):
        linear = replace(process, **others).respond(STEPS, 1.0)
        nearly = LossCurve().change(replace(process, **others), np.array([1e-7, 50.0])).respond(STEPS, 1.0)
        # A second lag sees straight lines from sample to sample.
        np.testing.assert_allclose(nearly, linear, atol=0.02 * np.ptp(linear))


def test_gain_and_time_constant_are_over_the_slope_of_the_losses():
    curvature = 0.05
    for level in (10.0, -10.0):
        after = np.where(np.arange(900) < 50, 0.0, level)
        at = losing(curvature).respond(50 + after, 1.0)[-1]
        assert at == pytest.approx(np.log1p(curvature * level) / curvature, abs=5e-3)
        moved = losing(curvature).respond(50 + after + 0.01 * (np.arange(900) >= 500), 1.0)
        moved = (moved - losing(curvature).respond(50 + after, 1.0))[500:] / 0.01
        slope = 1 + curvature * level
        assert moved[-1] == pytest.approx(1 / slope, rel=0.01)
        reached = np.interp(1 - np.exp(-1), moved / moved[-1], np.arange(len(moved)))
        assert reached - 2.0 == pytest.approx(TAU / slope, rel=0.02)


def test_a_vessel_that_radiates_is_nearly_such_a_process():
    absolute, moves = 60.0, STEPS - STEPS[0]
    inside = heated(np.repeat(moves, FINE), 0.0, 1 / (FINE * TAU), absolute)[FINE - 1 :: FINE]
    expected = np.append(np.zeros(3), inside[:-3])

    def off(process):
        response = process.respond(STEPS, 1.0)
        gain = response @ expected / (response @ response)
        return np.sqrt(np.mean((gain * response - expected) ** 2))

    assert off(losing(3 / absolute)) < 0.1 * off(LinearProcess(3.0, (TAU,)))


def test_losses_that_vanish_leave_a_response_that_is_finite():
    for curvature in (-0.2, 0.2):
        assert np.isfinite(losing(curvature).respond(STEPS, 1.0)).all()


def test_the_search_covers_losses_that_vanish_within_the_span_of_op():
    curvature, level = LossCurve().parameters(Facts(1.0, 100, 40.0, 60.0, 0.0, 1.0, 50.0, 1.0, 1))
    assert curvature.high == -curvature.low == pytest.approx(0.2)
    assert level.constant
    assert level.low == 50.0


def test_it_is_the_same_vessel_from_whatever_level_it_is_counted():
    curvature, slope = 0.05, 1 + 0.05 * 8.0
    there = LosingProcess(3.0, (TAU / slope,), curvature=curvature / slope, level=58.0)
    between = np.log(slope) / curvature
    np.testing.assert_allclose(
        losing(curvature).respond(STEPS, 1.0), between + there.respond(STEPS, 1.0) / slope, atol=1e-9
    )
