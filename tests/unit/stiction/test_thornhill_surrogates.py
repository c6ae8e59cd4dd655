"""Surrogates of linear and other waves; why their ends are matched."""

import numpy as np
import pytest
from scipy import signal

from agent.analysis.stiction.shapes.nearest_neighbours import prediction_error
from agent.analysis.stiction.shapes.phase_surrogates import ends_matched, surrogates
from agent.analysis.stiction.thornhill_surrogates import (
    COUNT,
    NEIGHBOURS,
    SEED,
    SurrogateErrors,
    ThornhillSurrogates,
    surrogate_errors,
)
from tests.unit.stiction.loops import detect, simulated

PERIOD = 15.0


def noise(n, seed):
    return np.random.default_rng(seed).normal(size=n)


def swinging_noise(seed, radius, n=600):
    poles = [1, -2 * radius * np.cos(2 * np.pi / PERIOD), radius**2]
    return signal.lfilter([1.0], poles, noise(n + 500, seed))[500:]


def limit_cycle(seed, n=800):
    """A sawtooth, rounded by nothing, whose period wanders slowly by a few per cent."""
    wandering = signal.lfilter([1.0], [1.0, -0.98], noise(n, seed))
    turns = np.cumsum(1 + 0.06 * wandering / np.std(wandering)) / PERIOD
    return signal.sawtooth(2 * np.pi * turns, 0.8) + 0.1 * noise(n, seed + 100)


def sine(seed, n=607):
    return np.sin(2 * np.pi * np.arange(n) / PERIOD) + 0.05 * noise(n, seed)


def index_without_matching(values):
    x = (values - np.mean(values)) / np.std(values)
    error, *others = (prediction_error(each, 15, NEIGHBOURS) for each in (x, *surrogates(x, COUNT, SEED)))
    return SurrogateErrors(error, np.array(others)).index


@pytest.mark.parametrize("radius", [0.9, 0.97, 0.99])
def test_a_linear_oscillation_is_linear(radius):
    assert all(surrogate_errors(swinging_noise(seed, radius), PERIOD).index < 1 for seed in range(4))


def test_a_limit_cycle_is_not():
    assert all(surrogate_errors(limit_cycle(seed), PERIOD).index > 1 for seed in range(4))


def test_without_end_matching_a_sine_looks_nonlinear():
    for seed in range(3):
        assert index_without_matching(sine(seed)) > 3
        assert surrogate_errors(sine(seed), PERIOD).index < 1


def test_the_index_counts_in_three_deviations():
    assert SurrogateErrors(4.0, np.array([9.0, 11.0])).index == pytest.approx(2.0)


@pytest.mark.parametrize("samples", [400, 401])
def test_surrogates_keep_the_spectrum_and_nothing_else(samples):
    x = limit_cycle(0)[:samples]
    made = surrogates(x, 5, 1)
    amplitude = np.abs(np.fft.rfft(x))
    np.testing.assert_allclose(np.abs(np.fft.rfft(made))[:, 1:], np.tile(amplitude[1:], (5, 1)), rtol=1e-8)
    np.testing.assert_allclose(made.mean(axis=1), 0.0, atol=1e-12)
    assert np.max(np.abs(np.corrcoef(made) - np.eye(5))) < 0.9
    np.testing.assert_array_equal(made, surrogates(x, 5, 1))


@pytest.mark.parametrize("period", [15.0, 17.3])
def test_matched_ends_hold_whole_periods(period):
    x = np.sin(2 * np.pi * np.arange(600) / period + 0.4) + 0.05 * noise(600, 1)
    part = ends_matched(x, round(period), round(3 * period))
    assert len(part) >= 600 - 7 * period
    turns = len(part) / period
    assert turns == pytest.approx(round(turns), abs=0.6 / period)


def test_what_repeats_itself_exactly_or_stands_still_has_no_index():
    assert surrogate_errors(np.tile(np.sin(2 * np.pi * np.arange(15) / 15), 40), PERIOD) is None
    assert surrogate_errors(np.zeros(600), PERIOD) is None


@pytest.mark.parametrize("period", [18.2, 61.7])
def test_verdicts(period):
    phase = 2 * np.pi * np.arange(2400) / period
    triangle = signal.sawtooth(phase, 0.5) + 0.05 * noise(2400, 0)
    for pv, verdict, word in (
        (np.sin(phase) + 0.05 * noise(2400, 0), "no_stiction", "is linear"),
        (triangle, "undecided", "third harmonic"),
    ):
        result = detect(ThornhillSurrogates(), noise(2400, 1), pv, period)
        assert result.verdict == verdict
        assert word in result.reason
    result = detect(ThornhillSurrogates(), noise(800, 1), limit_cycle(1), PERIOD)
    assert result.verdict == "undecided"
    assert "not linear" in result.reason


@pytest.mark.parametrize(
    ("samples", "period", "reason"), [(200, 15.0, "14 periods"), (600, 6.0, "7 samples a period")]
)
def test_its_limits(samples, period, reason):
    pv = np.sin(2 * np.pi * np.arange(samples) / period) + 0.1 * noise(samples, 0)
    result = detect(ThornhillSurrogates(), noise(samples, 1), pv, period)
    assert result.verdict == "not_applicable"
    assert reason in result.reason


def test_simulated_loops():
    assert ThornhillSurrogates().detect(*simulated("stiction", 28)[:2]).index > 1
    assert ThornhillSurrogates().detect(*simulated("sinusoid", 2)[:2]).index < 1
