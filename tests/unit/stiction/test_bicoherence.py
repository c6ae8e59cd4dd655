"""The bicoherence on noise, on waves with and without coupling, and its limits."""

import numpy as np
import pytest
from scipy import signal

from agent.analysis.stiction.bicoherence import (
    CRITICAL,
    F1,
    F2,
    LINES,
    NOT_GAUSSIAN,
    Bicoherence,
    SquaredBicoherence,
    best_hop,
    squared_bicoherence,
)
from tests.unit.stiction.loops import detect, simulated

HOP = 32


def noise(n, seed=0):
    return np.random.default_rng(seed).normal(size=n)


def swinging_noise(n, seed):
    """A linear oscillation, AR(2), that noise drives."""
    radius, period = 0.97, 15.0
    poles = [1, -2 * radius * np.cos(2 * np.pi / period), radius**2]
    return signal.lfilter([1.0], poles, noise(n + 500, seed))[500:]


def waves(n, period):
    phase = 2 * np.pi * np.arange(n) / period
    return {
        "sine": np.sin(phase),
        "square": np.sign(np.sin(phase + 0.01)),
        "triangle": signal.sawtooth(phase, 0.5),
        "asymmetric": signal.sawtooth(phase, 0.8),
    }


def seen(values, hop=HOP):
    squared = squared_bicoherence(values, hop)
    return SquaredBicoherence(squared, (len(values) - 64) // hop + 1, 1, 0.05, "absent")


@pytest.mark.parametrize(("samples", "segments"), [(1024, 31), (4096, 127)])
def test_chance_gives_one_over_the_number_of_segments(samples, segments):
    found = [seen(noise(samples, seed)) for seed in range(20)]
    assert {each.segments for each in found} == {segments}
    mean = np.mean([each.squared.mean() for each in found])
    assert mean == pytest.approx({31: 0.032, 127: 0.0082}[segments], rel=0.08)


def test_the_principal_domain_and_its_critical_mean():
    assert len(F1) == 1365
    assert np.all((F2 >= 1) & (F2 <= F1) & (2 * F1 + F2 <= LINES))
    assert pytest.approx(1 + 1.96 / np.sqrt(len(F1)), rel=1e-3) == CRITICAL


def test_short_records_of_a_linear_process_scatter_beyond_the_published_limit_but_not_beyond_ours():
    ngi = {n: [seen(swinging_noise(n, seed)).ngi for seed in range(60)] for n in (1024, 4096)}
    assert np.mean(np.array(ngi[1024]) > NOT_GAUSSIAN) > 0.2
    assert np.max(np.abs(ngi[4096])) < 0.0025
    assert sum(seen(swinging_noise(n, seed)).nonlinear for n in ngi for seed in range(60)) <= 2


def test_an_asymmetric_wave_couples_and_symmetric_ones_do_not():
    for name, wave in waves(4096, 20.0).items():
        ngi = seen(wave + 0.01 * np.std(wave) * noise(4096)).ngi
        if name == "asymmetric":
            assert ngi > 0.2
        else:
            assert ngi <= NOT_GAUSSIAN


def test_a_triangle_of_0_26():
    wave = waves(4096, 12.3)["asymmetric"]
    assert seen(wave + 0.01 * np.std(wave) * noise(4096)).ngi == pytest.approx(0.26, abs=0.02)


def test_the_peak_is_where_the_phases_go_together():
    rng = np.random.default_rng(3)
    first, second, third = rng.uniform(0, 2 * np.pi, (3, 64))
    t = np.arange(64)
    for phase_of_sum, coupled in ((first + second, True), (third, False)):
        angles = [(0.0625, second), (0.171875, first), (0.234375, phase_of_sum)]
        pieces = sum(np.cos(2 * np.pi * f * t + phase[:, None]) for f, phase in angles)
        found = seen(pieces.ravel() + 0.1 * noise(pieces.size), hop=64)
        at = found.squared[(F2 == 8) & (F1 == 22)]
        assert (at > 0.9) == coupled
        if coupled:
            assert found.peak == pytest.approx((0.0625, 0.171875), abs=2 / LINES)


def test_a_steady_wave_that_begins_each_segment_alike_looks_coupled_so_the_hop_avoids_it():
    wave = np.sin(2 * np.pi * np.arange(2000) / 16.0) + 0.01 * noise(2000)
    assert seen(wave, hop=32).nonlinear
    hop = best_hop(1 / 16.0)
    assert not seen(wave, hop).nonlinear


@pytest.mark.parametrize("period", [18.2, 61.7])
def test_a_sine_is_linear_and_a_symmetric_triangle_is_left_open(period):
    for name, verdict, word in (
        ("sine", "no_stiction", "linear"),
        ("triangle", "undecided", "third harmonic"),
        ("asymmetric", "undecided", "not linear"),
    ):
        wave = waves(4000, period)[name]
        result = detect(Bicoherence(), noise(4000, 1), wave + 0.05 * np.std(wave) * noise(4000), period)
        assert result.verdict == verdict
        assert word in result.reason


@pytest.mark.parametrize(
    ("pv", "period", "reason"),
    [
        (noise(250), 20.0, "segments"),
        (noise(2000), 150.0, "segments"),
        (noise(2000), 5.0, "samples a period"),
        (noise(2000), 500.0, "periods"),
        (np.zeros(2000), 20.0, "does not move"),
    ],
)
def test_its_limits(pv, period, reason):
    result = detect(Bicoherence(), noise(len(pv), 1), pv, period)
    assert result.verdict == "not_applicable"
    assert reason in result.reason


def test_a_record_too_short_to_call_it_linear():
    wave = waves(600, 18.2)["sine"] + 0.05 * noise(600)
    result = detect(Bicoherence(), noise(600, 1), wave, 18.2)
    assert result.verdict == "undecided"
    assert "30 are needed" in result.reason


def test_it_never_names_stiction():
    result = Bicoherence().detect(*simulated("stiction", 10)[:2])
    assert result.verdict == "undecided"
    assert result.seen.nonlinear
    assert not Bicoherence().detect(*simulated("sinusoid", 10)[:2]).seen.nonlinear
