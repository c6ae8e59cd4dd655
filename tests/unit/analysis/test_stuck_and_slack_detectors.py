"""Hägglund's backlash, Damarla's windows and Srinivasan's cycles, by hand and on simulated loops."""

from functools import cache

import numpy as np
import pytest
from scipy import special, stats

from agent.analysis.loop.pi_controller import PiController
from agent.analysis.oscillation import detect_oscillation
from agent.analysis.record.recording import LoopHints, LoopWindow
from agent.analysis.results import Oscillation
from agent.analysis.stiction.damarla import WINDOW, Damarla, is_arranged, slope, varies
from agent.analysis.stiction.hagglund_backlash import HagglundBacklash, dead_band
from agent.analysis.stiction.shapes.time_warping import warped_distances
from agent.analysis.stiction.srinivasan_dtw import TEMPLATES, SrinivasanDtw, labelled
from simulators.draws.random_plants import random_plant
from simulators.plant import simulate
from tests.reference.time_warping_recursive import warped_distance

PERIOD = 100
STEADY = Oscillation(detected=True, period=float(PERIOD), regularity=3.0)
TIME = np.arange(1200) / PERIOD + 0.013


@cache
def simulated(kind, seed, mv_noise=0.05):
    scenario = random_plant(seed, kind)
    record = simulate(scenario)
    noise = mv_noise * np.std(record.mv) * np.random.default_rng(seed).normal(size=record.mv.size)
    hints = LoopHints(integrating=scenario.process.kind == "integrating")
    window = LoopWindow(kind, 0.0, 1.0, record.op, record.pv, record.sp, record.mv + noise, hints=hints)
    return window, detect_oscillation(window), scenario.valve


def test_the_formula_of_hagglund():
    controller = PiController(kc=0.8, ki=0.8 / 20, explained=1.0)
    assert dead_band(120.0, 1.5, controller) == pytest.approx((0.8 * 120 / 20) * 1.5)
    assert dead_band(120.0, 1.5, controller, gain=-2.0) == pytest.approx((0.8 * 120 / 20 - 1 / 2) * 1.5)


@pytest.mark.parametrize("seed", [3, 10, 31])
def test_backlash_of_simulated_valves_with_long_half_cycles_is_an_upper_bound(seed):
    window, oscillation, valve = simulated("stiction", seed)
    found = HagglundBacklash().detect(window, oscillation)
    assert found.verdict == "stiction", found.reason
    s = valve.f_s + valve.f_d
    assert 0.97 * s < found.seen.dead_band < 1.35 * s
    assert found.index == pytest.approx(found.seen.dead_band / window.op_span)


@pytest.mark.parametrize("seed", [4, 5])
def test_a_swinging_load_has_no_square_error(seed):
    found = HagglundBacklash().detect(*simulated("sinusoid", seed)[:2])
    assert found.verdict in ("undecided", "not_applicable")


def test_limits_of_the_backlash_are_named():
    def reason(window, oscillation):
        result = HagglundBacklash().detect(window, oscillation)
        assert result.verdict == "not_applicable"
        return result.reason

    short, oscillation, _ = simulated("stiction", 2)
    assert "integral times" in reason(short, oscillation)
    assert "integrating" in reason(short.with_hints(LoopHints(integrating=True)), oscillation)
    rng = np.random.default_rng(0)
    unrelated = LoopWindow("x", 0.0, 1.0, rng.normal(size=1200), np.sin(2 * np.pi * TIME))
    assert "PI law" in reason(unrelated, STEADY)


def test_tests_of_single_windows():
    ramp, flat = np.arange(WINDOW, dtype=float), np.zeros(WINDOW)
    alternating = np.array([1.0, -1.0, 1.0, -1.0, 1.0, -1.0])
    windows = np.stack([ramp, -ramp, flat, alternating])
    np.testing.assert_allclose(slope(windows)[:3], [1.0, 1.0, 0.0])
    assert varies(windows).tolist() == [True, True, False, False]
    assert is_arranged(windows).tolist() == [True, True, False, False]


def test_levels_of_the_tests_on_noise():
    """Six samples have 720 arrangements, 40 of them beyond the limit."""
    noise = np.random.default_rng(7).normal(size=(20_000, WINDOW))
    assert np.mean(is_arranged(noise)) == pytest.approx(40 / 720, abs=0.005)
    assert np.mean(varies(noise)) < 0.05


def test_reverse_arrangements_are_kendalls_tau():
    windows = np.random.default_rng(8).normal(size=(50, WINDOW))
    falls = [
        -stats.kendalltau(np.arange(WINDOW), each).statistic * WINDOW * (WINDOW - 1) / 2 for each in windows
    ]
    deviation = np.sqrt(WINDOW * (WINDOW - 1) * (2 * WINDOW + 5) / 18)
    expected = np.abs(falls) / deviation > -special.ndtri(0.025)
    np.testing.assert_array_equal(is_arranged(windows), expected)


@pytest.mark.parametrize(
    ("kind", "verdict"), [("stiction", "stiction"), ("sinusoid", "no_stiction"), ("tuning", "no_stiction")]
)
@pytest.mark.parametrize("seed", [2, 4])
def test_damarla_where_the_stem_is_measured(kind, verdict, seed):
    found = Damarla().detect(*simulated(kind, seed)[:2])
    assert found.verdict == verdict, found.reason


def test_the_stick_band_is_the_travel_of_op_while_the_stem_stands():
    window, oscillation, valve = simulated("stiction", 2, mv_noise=0.0)
    band = Damarla().detect(window, oscillation).seen.stick_band
    assert 0.5 * (valve.f_s + valve.f_d) < band < 1.3 * (valve.f_s + valve.f_d)


def test_warping_against_its_definition():
    rng = np.random.default_rng(9)
    curves, templates = rng.normal(size=(3, 12)), rng.normal(size=(2, 12))
    for band in (0, 2, 12):
        found = warped_distances(curves, templates, band)
        expected = [[warped_distance(a, b, band) for b in templates] for a in curves]
        np.testing.assert_allclose(found, expected, rtol=1e-12)


def test_without_a_band_warping_is_the_mean_square_and_a_shift_costs_little_with_one():
    curve = np.sin(np.linspace(0, 6, 50))
    late = np.roll(curve, 2)
    assert warped_distances(curve[None], late[None], 0)[0, 0] == pytest.approx(np.mean((curve - late) ** 2))
    assert warped_distances(curve[None], late[None], 3)[0, 0] < 0.2 * np.mean((curve - late) ** 2)


@pytest.mark.parametrize("shape", list(TEMPLATES))
def test_a_noisy_cycle_is_nearest_to_its_own_template(shape):
    noise = 0.05 * np.random.default_rng(3).normal(size=(20, 100))
    labels = labelled(TEMPLATES[shape] + noise).labels
    assert set(labels) == {list(TEMPLATES).index(shape)}


@pytest.mark.parametrize(("share", "verdict"), [(0.0, "no_stiction"), (0.5, "undecided"), (1.0, "stiction")])
def test_stiction_that_comes_and_goes_is_found_cycle_by_cycle(share, verdict):
    triangle = 4 * np.abs((TIME + 0.25) % 1 - 0.5) - 1
    op = np.where(share * len(TIME) > np.arange(len(TIME)), triangle, np.sin(2 * np.pi * (TIME + 0.75)))
    pv = np.sin(2 * np.pi * TIME)
    found = SrinivasanDtw().detect(LoopWindow("x", 0.0, 1.0, op, pv), STEADY)
    assert found.verdict == verdict, found.reason
    assert found.index == pytest.approx(share, abs=0.1)


@pytest.mark.parametrize("seed", [2, 4])
def test_srinivasan_on_swinging_loads(seed):
    assert SrinivasanDtw().detect(*simulated("sinusoid", seed)[:2]).verdict == "no_stiction"
