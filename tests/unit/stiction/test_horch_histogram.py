"""Horch's histogram on waves of known shape and on simulated loops."""

import numpy as np
import pytest
from scipy import signal

from agent.analysis.record.recording import LoopHints
from agent.analysis.stiction.horch_histogram import (
    TWO_HUMPS,
    HorchHistogram,
    derivative_histogram,
    noise_in_derivative,
)
from tests.unit.stiction.loops import detect, simulated

PERIOD = 60.0
ANGLE = 2 * np.pi * np.arange(1500) / PERIOD
WAVES = {
    "sine": np.sin(ANGLE),
    "square": np.sign(np.sin(ANGLE + 0.01)),
    "triangle": signal.sawtooth(ANGLE, 0.5),
}


def waved(shape, noise):
    wave = WAVES[shape]
    return wave + noise * np.std(wave) * np.random.default_rng(0).normal(size=len(wave))


@pytest.mark.parametrize("noise", [0.05, 0.15])
@pytest.mark.parametrize(
    ("shape", "integrating", "verdict"),
    [
        ("sine", False, "no_stiction"),
        ("sine", True, "no_stiction"),
        ("square", False, "stiction"),
        ("triangle", True, "stiction"),
    ],
)
def test_waves(shape, integrating, verdict, noise):
    hints = LoopHints(integrating=integrating)
    op, pv = np.sin(ANGLE), waved(shape, noise)
    assert detect(HorchHistogram(), op, pv, PERIOD, hints=hints).verdict == verdict


def test_a_density_integrates_to_one_and_the_better_fit_gives_the_sign():
    seen = derivative_histogram(waved("sine", 0.1), PERIOD, 1)
    width = seen.centres[1] - seen.centres[0]
    assert np.sum(seen.density) * width == pytest.approx(1.0)
    errors = [np.mean((seen.density - fit) ** 2) for fit in (seen.camel, seen.gaussian)]
    assert seen.index == pytest.approx(np.log(errors[0] / errors[1]))
    assert seen.index < 0


def test_the_camel_keeps_its_two_humps():
    """The density of a sine and noise has one hump from there on (derived in the module)."""
    x = np.linspace(-0.05, 0.05, 3)
    phases = np.sin(np.linspace(0, 2 * np.pi, 5000, endpoint=False))
    for noise, bend in ((0.97 * TWO_HUMPS, 1), (1.03 * TWO_HUMPS, -1)):
        density = np.exp(-(((x[:, None] - phases) / noise) ** 2) / 2).mean(axis=1)
        assert np.sign(np.diff(density, 2)[0]) == bend


def test_noise_in_the_derivative_is_what_the_filter_leaves():
    rng = np.random.default_rng(1)
    n, period, share = 60_000, 60.0, 0.2
    noise = share * rng.normal(size=n) / np.sqrt(2)
    wave = np.sin(2 * np.pi * np.arange(n) / period)
    spectrum = np.fft.rfft(noise)
    spectrum[np.fft.rfftfreq(n) > 3.0 / period] = 0.0
    left = np.fft.irfft(spectrum, n)
    for order in (1, 2):
        exact = np.std(np.diff(left, order)) / np.std(np.diff(wave, order))
        assert noise_in_derivative(wave + noise, period, order) == pytest.approx(exact, rel=0.1)


@pytest.mark.parametrize(
    ("pv", "period", "reason"),
    [
        (waved("sine", 1.5), PERIOD, "noise"),
        (waved("sine", 0.1)[:280], PERIOD, "5 periods"),
        (np.sin(ANGLE * PERIOD / 8), 8.0, "samples a period"),
        (np.sin(ANGLE) * (1 + 0.8 * np.sin(ANGLE / 7)), PERIOD, "differ too much"),
    ],
)
def test_its_limits(pv, period, reason):
    result = detect(HorchHistogram(), pv, pv, period)
    assert result.verdict == "not_applicable"
    assert reason in result.reason


def test_simulated_loops():
    assert HorchHistogram().detect(*simulated("stiction", 0)[:2]).verdict == "stiction"
    assert HorchHistogram().detect(*simulated("sinusoid", 0)[:2]).verdict == "no_stiction"
    assert HorchHistogram().detect(*simulated("tuning", 0)[:2]).verdict == "not_applicable"
