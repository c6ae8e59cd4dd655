"""Oscillation detectors on signals whose answer is known."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.signal import chirp, lfilter

from agent.analysis.oscillation import DETECTORS, HagglundMonitor, detect_oscillation
from agent.analysis.oscillation.acf_zero_crossings import autocorrelation
from agent.analysis.oscillation.hagglund import HalfCycles
from agent.analysis.record.recording import LoopWindow
from agent.analysis.record.signals import detrended, noise_level
from connectors.recording import read_recording

N = 1000
T = np.arange(N)


def window(pv, op=None, sp=None, ts=1.0):
    return LoopWindow("x", 0.0, ts, op=np.zeros(len(pv)) if op is None else op, pv=np.asarray(pv), sp=sp)


def sine(period, phase=0.3):
    return np.sin(2 * np.pi * T / period + phase)


def noise(seed, n=N):
    return np.random.default_rng(seed).normal(size=n)


@pytest.mark.parametrize("detector", DETECTORS, ids=lambda detector: detector.name)
@pytest.mark.parametrize("period", [10, 37.5, 70])
def test_each_detector_finds_a_noisy_sine_and_its_period(detector, period):
    seen = detector.detect(window(sine(period) + 0.1 * noise(0)))
    assert seen.detected
    assert seen.period == pytest.approx(period, rel=0.02)
    assert seen.regularity is None or seen.regularity > 1


@pytest.mark.parametrize(
    "shape",
    [np.sign(sine(80)), np.abs((T % 80) - 40.0), T % 80 * 1.0, np.where(T % 80 < 20, 1.0, 0.0)],
    ids=["square", "triangle", "saw", "asymmetric"],
)
def test_shapes_of_limit_cycles(shape):
    seen = detect_oscillation(window(shape + 0.05 * noise(1)))
    assert seen.detected
    assert seen.period == pytest.approx(80, rel=0.02)


def test_a_wave_that_only_op_shows():
    assert detect_oscillation(window(noise(2), op=50 + sine(50))).detected


def test_wave_below_the_noise():
    seen = detect_oscillation(window(sine(50) + 1.0 * noise(3)))
    assert seen.detected
    assert seen.period == pytest.approx(50, rel=0.05)


def test_wave_on_a_drift():
    seen = detect_oscillation(window(sine(50) + 0.05 * T))
    assert seen.detected
    assert seen.period == pytest.approx(50, rel=0.02)


@pytest.mark.parametrize("pole", [0.0, 0.5, 0.9, 0.97])
def test_noise_of_any_colour_is_no_oscillation(pole):
    """At most 5 % false alarms of 100; slow noise crosses zero as well, but not regularly."""
    alarms = 0
    for seed in range(100):
        coloured = lfilter([1.0], [1.0, -pole], noise(seed, 2500))[500:]
        alarms += detect_oscillation(window(coloured, op=coloured)).detected
    assert alarms <= 5


def test_a_wave_whose_period_wanders():
    """Standard deviation 30 % of the period, heights that differ: no line, no regular crossings."""
    seen = 0
    for seed in range(20):
        rng = np.random.default_rng(seed)
        cycles = [
            np.exp(0.5 * rng.normal()) * np.sin(2 * np.pi * np.arange(length) / length)
            for length in (75 * np.exp(0.3 * rng.normal(size=40))).astype(int).tolist()
        ]
        wave = np.concatenate(cycles)[:1500] + 0.1 * rng.normal(size=1500)
        found = detect_oscillation(window(wave, op=wave))
        seen += found.detected and 40 < found.period < 150
    assert seen >= 18


def test_a_chirp_oscillates_but_is_not_regular():
    swept = chirp(T, f0=1 / 200, t1=N, f1=1 / 8)
    seen = detect_oscillation(window(swept, op=swept))
    assert seen.detected
    assert seen.regularity < 1


@pytest.mark.parametrize("flat", [np.zeros(N), np.full(N, 1e9), np.full(N, np.nan), T * 0.1, [1.0], []])
def test_nothing_that_moves(flat):
    seen = detect_oscillation(window(flat, op=np.asarray(flat)))
    assert (seen.detected, seen.period, seen.regularity) == (False, None, None)


def test_alternating_samples_are_quantisation_not_a_wave():
    alternating = np.where(T % 2 == 0, 1.0, -1.0)
    assert not DETECTORS[1].detect(window(alternating)).detected


def test_gaps_are_left_out_not_filled():
    wave = sine(50) + 0.1 * noise(4)
    wave[np.random.default_rng(5).random(N) < 0.2] = np.nan
    wave[400:460] = np.nan
    seen = detect_oscillation(window(wave))
    assert seen.detected
    assert seen.period == pytest.approx(50, rel=0.03)


@pytest.mark.parametrize(("scale", "offset"), [(1e-9, 0), (1e9, 0), (1, 1e4), (-3, -50), (1e14, 0)])
def test_units_and_offset_do_not_matter(scale, offset):
    wave = sine(50) + 0.1 * noise(6)
    one, other = detect_oscillation(window(wave)), detect_oscillation(window(scale * wave + offset))
    assert one.detected
    assert other.detected
    assert other.period == pytest.approx(one.period, rel=1e-6)
    assert other.regularity == pytest.approx(one.regularity, rel=1e-3)


def test_period_scales_with_the_sampling_time():
    assert detect_oscillation(window(sine(50), ts=20.0)).period == pytest.approx(1000, rel=0.01)


def test_set_point_belongs_to_the_error():
    moving = np.repeat(noise(7, 10), 100) * 5
    assert detect_oscillation(window(moving + sine(25) + 0.05 * noise(8), sp=moving)).detected


@settings(deadline=None, max_examples=60)
@given(st.lists(st.floats(width=64), max_size=80), st.lists(st.floats(width=64), max_size=80))
def test_no_content_raises(pv, op):
    n = min(len(pv), len(op))
    for sp in (None, np.array(op[:n])):
        seen = detect_oscillation(window(np.array(pv[:n]), op=np.array(op[:n]), sp=sp))
        for number in (seen.period, seen.regularity):
            assert number is None or math.isfinite(number)


def test_autocorrelation_is_that_of_the_definition():
    x = noise(9, 60)
    x[[3, 17, 18]] = np.nan
    found = autocorrelation(x)
    power = np.nanmean(x**2)
    for lag in range(31):
        products = x[: 60 - lag] * x[lag:]
        assert found.r[lag] == pytest.approx(np.nanmean(products) / power, abs=1e-12)
        assert found.pairs[lag] == np.count_nonzero(np.isfinite(products))


def test_noise_level_sees_noise_and_no_slow_wave():
    assert noise_level(20 * sine(200) + noise(10)) == pytest.approx(1, rel=0.1)


def test_detrended_is_zero_for_a_line():
    assert not detrended(3.0 + 0.2 * T).any()


class TestHalfCycles:
    def cut(self, errors, dead_band=0.0):
        cutter = HalfCycles(2.0, dead_band)
        return [ended for ended in map(cutter.push, errors) if ended is not None]

    def test_area_and_duration(self):
        ended = self.cut([1, -1, -2, -3, 4, 4, -1])
        assert [(half.duration, half.iae) for half in ended] == [(6, 12), (4, 16)]

    def test_part_before_the_first_crossing_does_not_count(self):
        assert self.cut([5, 5, 5, -1, -1]) == []

    def test_gap_starts_anew(self):
        assert self.cut([1, -1, -1, math.nan, 1, 1, -1]) == []

    def test_noise_within_the_dead_band_does_not_cross(self):
        assert len(self.cut([1, -1, 0.1, -0.1, -1, 1], dead_band=0.2)) == 1

    def test_limit_is_the_area_of_half_a_sine(self):
        half = 100
        wave = np.sin(np.pi * (np.arange(half * 4) + 0.5) / half)
        for ended in self.cut(wave):
            assert ended.is_load(0.99)
            assert not ended.is_load(1.01)


class TestMonitor:
    def test_alarm_after_six_periods_and_silence_when_it_ends(self):
        monitor = HagglundMonitor(1.0, amplitude=0.5)
        alarms = [monitor.push(error) for error in sine(40)]
        first = alarms.index(True)
        assert 5 * 40 < first < 7 * 40
        assert all(alarms[first:])
        calm = [monitor.push(1.0) for _ in range(10_000)]
        assert not calm[-1]

    def test_small_waves_do_not_count(self):
        monitor = HagglundMonitor(1.0, amplitude=1.1)
        assert not any(monitor.push(error) for error in sine(40))

    def test_memory_does_not_grow(self):
        monitor = HagglundMonitor(1.0, amplitude=0.1)
        sizes = set()
        for error in np.tile(sine(40), 5):
            monitor.push(float(error))
            sizes.add(len(vars(monitor)) + len(vars(monitor._half_cycles)))
        assert len(sizes) == 1


@pytest.mark.parametrize(
    ("name", "period"), [("CHEM10", 140), ("CHEM11", 126), ("CHEM12", 475), ("PAP2", 42)]
)
def test_industrial_loops_with_stiction_oscillate(recordings, name, period):
    loop = read_recording(recordings / "isdb" / f"{name}.csv")
    seen = detect_oscillation(window(loop.pv, op=loop.op))
    assert seen.detected
    assert seen.period == pytest.approx(period, rel=0.02)
