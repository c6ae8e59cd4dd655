"""Each oscillation detector on its analytic cases, several oscillations at once, and the online forms."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.signal import lfilter

from agent.analysis.oscillation import (
    ForsmanStattinMonitor,
    HagglundMonitor,
    detect_oscillation,
    oscillations,
)
from agent.analysis.oscillation.acf_filtered import (
    POINTS,
    _correlation_of_filtered_noise,
    band_passed,
)
from agent.analysis.oscillation.forsman_stattin import ForsmanStattin, alike
from agent.analysis.oscillation.hagglund import HalfCycle, HalfCycles, _oscillates, half_cycles
from agent.analysis.oscillation.miao_seborg import decay_ratio
from agent.analysis.oscillation.spectral import highest_peak
from agent.analysis.oscillation.spectrum import bridged, spectrum
from agent.analysis.record.recording import LoopWindow

N = 2000
T = np.arange(N)


def window(pv, op=None, ts=1.0):
    return LoopWindow("x", 0.0, ts, op=pv if op is None else op, pv=pv)


def sine(period, phase=0.3):
    return np.sin(2 * np.pi * T / period + phase)


def noise(seed, n=N):
    return np.random.default_rng(seed).normal(size=n)


def periods(seen):
    return [pytest.approx(each.period, rel=0.03) for each in seen]


class TestSeveralOscillations:
    def test_two_waves_are_distinguished_the_stronger_first(self):
        seen = oscillations(window(2 * sine(150) + sine(27) + 0.2 * noise(1)))
        assert periods(seen) == [150, 27]
        assert seen[0].share == pytest.approx(0.8, abs=0.05)

    def test_a_wave_hidden_by_a_drift(self):
        walk = np.cumsum(noise(2)) / 5
        assert np.std(walk) > 1
        (seen,) = oscillations(window(sine(40) + walk))
        assert seen.period == pytest.approx(40, rel=0.02)
        assert seen.share < 0.5

    def test_harmonics_are_no_oscillations_of_their_own(self):
        assert periods(oscillations(window(np.sign(sine(120)) + 0.05 * noise(3)))) == [120]

    def test_op_and_pv_may_show_different_ones(self):
        seen = oscillations(window(sine(150) + 0.1 * noise(4), op=sine(27) + 0.1 * noise(5)))
        assert sorted(round(each.period) for each in seen) == [27, 150]

    def test_less_than_one_per_cent_of_the_power_is_ignored(self):
        assert periods(oscillations(window(sine(150) + 0.05 * sine(27) + 0.001 * noise(6)))) == [150]

    def test_it_is_left_out_of_a_gap(self):
        lost = 0.1 * noise(7) + sine(40)
        lost[600:700] = np.nan
        assert periods(oscillations(window(lost))) == [40]

    @pytest.mark.parametrize("pole", [0.0, 0.9, 0.99, 1.0])
    def test_noise_has_none(self, pole):
        """At most 5 % of 40."""
        alarms = sum(
            bool(oscillations(window(lfilter([1.0], [1.0, -pole], noise(seed))))) for seed in range(40)
        )
        assert alarms <= 2

    def test_the_table_of_filtered_noise_is_that_of_noise(self):
        period = 20
        filtered = band_passed(noise(8, 200_000), period)
        lags = np.arange(0, 40, 4)
        measured = [np.mean(filtered[: filtered.size - k] * filtered[k:]) for k in lags]
        tabled = _correlation_of_filtered_noise()[lags * POINTS // period]
        np.testing.assert_allclose(np.array(measured) / measured[0], tabled, atol=0.05)


def test_three_slow_periods_are_seen_by_their_power():
    seen = detect_oscillation(window(sine(620) + 0.05 * noise(9)))
    assert seen.detected
    assert seen.regularity is None
    assert seen.period == pytest.approx(620, rel=0.05)


class TestSpectrum:
    def test_share_of_a_wave_in_white_noise(self):
        share, period = highest_peak(sine(50) + noise(10))  # powers 1/2 and 1
        assert share == pytest.approx(1 / 3, abs=0.08)
        assert period == pytest.approx(50, rel=0.01)

    @pytest.mark.parametrize("slope", [0, 1, 2])
    def test_nothing_stands_out_of_a_power_law(self, slope):
        found = spectrum(noise(11))
        found.power[1:] = found.frequency[1:] ** -slope
        assert found.prominence(100) == pytest.approx(1, rel=0.05)

    def test_prominence_of_a_line(self):
        found = spectrum(noise(12))
        found.power[:] = 1.0
        found.power[100] = 340.0  # of about 34 lines near it
        assert found.prominence(100) == pytest.approx(1 + 339 / found.near(100).size)

    def test_bridges(self):
        np.testing.assert_allclose(bridged(np.array([1.0, np.nan, 3.0, 4.0])), [1, 2, 3, 4])
        assert bridged(np.full(5, np.nan)) is None
        assert bridged(np.zeros(5)) is None


class TestMiaoSeborg:
    def test_a_steady_wave_does_not_decay(self):
        decay = decay_ratio(sine(50))
        assert decay.ratio == pytest.approx(1, abs=0.01)
        assert decay.period == 50

    @pytest.mark.parametrize(("damping", "excessive"), [(0.02, True), (0.05, True), (0.3, False)])
    def test_a_resonance_driven_by_noise(self, damping, excessive):
        w = 2 * np.pi / 30
        poles = np.exp(w * (-damping + 1j * np.sqrt(1 - damping**2)))
        response = lfilter([1.0], [1.0, -2 * poles.real, abs(poles) ** 2], noise(13))
        decay = decay_ratio(response)
        assert (decay is not None and decay.ratio > 0.5) == excessive

    def test_it_needs_four_periods_in_a_quarter_of_the_record_or_says_nothing(self):
        assert decay_ratio(sine(500)) is None
        assert decay_ratio(noise(14)) is None


class TestForsmanStattin:
    def test_half_cycles_are_alike_within_the_limits_both_ways(self):
        one = HalfCycle(duration=10.0, iae=5.0)
        assert alike(one, HalfCycle(13.0, 8.0))
        assert alike(HalfCycle(13.0, 8.0), one)
        assert not alike(one, HalfCycle(13.4, 5.0))
        assert not alike(one, HalfCycle(10.0, 8.4))

    def test_sides_may_differ(self):
        u = T % 80
        lopsided = np.where(u < 20, 3 * np.sin(np.pi * u / 20), -np.sin(np.pi * (u - 20) / 60))
        assert ForsmanStattin().detect(window(lopsided)).detected

    def test_index_of_a_steady_wave_is_that_of_the_paper(self):
        """N half cycles have N - 2 that can be compared."""
        monitor = ForsmanStattinMonitor(1.0)
        ended = [half for half in map(monitor.push, sine(40).tolist()) if half is not None]
        assert monitor.index == pytest.approx((len(ended) - 2) / len(ended))

    def test_it_equals_the_definition_on_noise(self):
        monitor = ForsmanStattinMonitor(1.0)
        ended = [half for half in map(monitor.push, noise(15).tolist()) if half is not None]
        count = sum(alike(one, other) for one, other in zip(ended, ended[2:], strict=False))
        assert monitor.index == pytest.approx(count / len(ended))

    def test_with_a_memory_it_forgets_an_oscillation_that_ended(self):
        monitor = ForsmanStattinMonitor(1.0, memory=10)
        for error in sine(40):
            monitor.push(error)
        assert monitor.index > 0.95
        for error in noise(16):
            monitor.push(error)
        assert monitor.index < 0.5

    def test_a_gap_parts_half_cycles(self):
        monitor = ForsmanStattinMonitor(1.0)
        for error in [1, -1, 1, -1, math.nan, 1, -1, 1, -1]:
            monitor.push(error)
        assert monitor.index == 0

    def test_memory_does_not_grow(self):
        monitor = ForsmanStattinMonitor(1.0, memory=10)
        fields = len(vars(monitor))
        for error in sine(40).tolist():
            monitor.push(error)
            assert len(monitor._last_two) <= 2
        assert len(vars(monitor)) == fields


class TestWholeRecordsAtOnce:
    """The batch forms skip the samples between crossings; the online forms see each."""

    @given(
        st.lists(st.sampled_from([-1.5, -1.0, -0.2, 0.0, 0.2, 1.0, 1.5, math.nan]), max_size=300),
        st.sampled_from([0.0, 0.5]),
        st.sampled_from([1.0, 2.5]),
    )
    @settings(deadline=None)
    def test_they_are_those_of_the_online_forms(self, errors, band, ts):
        cutter, resembling = HalfCycles(ts, band), ForsmanStattinMonitor(ts, band)
        monitor, loaded = HagglundMonitor(ts, band, band), False
        online = []
        for k, error in enumerate(errors):
            ended = cutter.push(error)
            resembling.push(error)
            loaded = monitor.push(error)
            online += [] if ended is None else [(k, ended)]
        batch = half_cycles(np.array(errors), ts, band)
        assert [(end, ended) for end, _, ended in batch] == online
        assert _oscillates(batch, len(errors), ts, band) == loaded
        whole, former = ForsmanStattinMonitor(ts), 0
        for _, gaps, ended in batch:
            whole.take(ended, gap=gaps != former)
            former = gaps
        assert whole.index == resembling.index
