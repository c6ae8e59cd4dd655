"""The shapes of half cycles: the indices of sine, triangle and square, and the limits before them."""

import numpy as np
import pytest
from scipy import optimize

from agent.analysis.oscillation import detect_oscillation
from agent.analysis.record.recording import LoopHints, LoopWindow
from agent.analysis.results import Oscillation
from agent.analysis.stiction import hagglund_shape, he_curve_fit, rossi_scali
from agent.analysis.stiction.hagglund_shape import HagglundShape
from agent.analysis.stiction.he_curve_fit import HeCurveFit
from agent.analysis.stiction.rossi_scali import RossiScali
from agent.analysis.stiction.shapes.half_cycle_shapes import POINTS, RELAY, SINE, TRIANGLE, T, fit, resampled

SHAPES = {"sine": np.sin(np.pi * T), "triangle": 1 - np.abs(2 * T - 1), "square": np.ones(POINTS)}
TIME = np.arange(1200) / 100 + 0.013
WAVES = {
    "sine": np.sin(2 * np.pi * TIME),
    "triangle": 4 * np.abs(TIME % 1 - 0.5) - 1,
    "square": np.where(TIME % 1 < 0.5, 1.0, -1.0),
}
STEADY = Oscillation(detected=True, period=100.0, regularity=3.0)
DETECTORS = [HeCurveFit(), RossiScali(), HagglundShape()]


def index(method, shape):
    half_cycles = 3.7 * np.tile(SHAPES[shape], (4, 1))
    return method.index(method.measures(half_cycles).mean(axis=0))


@pytest.mark.parametrize(
    ("method", "sine", "triangle", "square"),
    [
        (he_curve_fit, 0.000, 0.994, 0.43),
        (rossi_scali, -1.00, 0.86, 0.62),
        (hagglund_shape, -1.00, -0.88, 1.00),
    ],
    ids=["he", "rossi", "hagglund"],
)
def test_indices_of_pure_shapes(method, sine, triangle, square):
    """The values of the reference; a triangle's peak lies half a point beside the nearest candidate."""
    assert index(method, "sine") == pytest.approx(sine, abs=0.005)
    assert index(method, "triangle") == pytest.approx(triangle, abs=0.015)
    assert index(method, "square") == pytest.approx(square, abs=0.005)


@pytest.mark.parametrize("shape", [SINE, TRIANGLE, RELAY])
def test_a_shape_fits_itself_at_any_height(shape):
    for column in shape.T[::17]:
        fitted = fit(-2.5 * column[None, :] * -3.0, shape)
        assert fitted.error[0] == pytest.approx(0.0, abs=1e-12)
        np.testing.assert_allclose(fitted.curves[0], 7.5 * column, atol=1e-6)


def test_the_fit_of_a_triangle_is_the_best_of_all_heights_and_peaks():
    half = np.random.default_rng(3).uniform(0.2, 1.0, (5, POINTS))

    def error(peak, values):
        shape = np.where(peak >= T, T / peak, (1 - T) / (1 - peak))
        return optimize.minimize_scalar(lambda height: np.mean((values - height * shape) ** 2)).fun

    slow = [min(error(peak, values) for peak in T) for values in half]
    np.testing.assert_allclose(fit(half, TRIANGLE).error, slow, rtol=1e-9)


def test_a_relay_switches_a_first_order_process_with_dead_time():
    """Integrated step by step: input 1 up to the dead time, then -1; back at zero at the end."""
    tau = np.geomspace(0.015, 10.0, 60)[35]
    dead_time = tau * np.log((1 + np.exp(1 / tau)) / 2)
    fine = (np.arange(100_000) + 0.5) / 100_000
    drive = np.where(fine < dead_time, 1.0, -1.0)
    y = np.empty(fine.size)
    state = 0.0
    for k, u in enumerate(drive.tolist()):
        state += (u - state) / tau / fine.size
        y[k] = state
    assert y[-1] == pytest.approx(0.0, abs=1e-3)
    at_points = np.interp(T, fine, y)
    np.testing.assert_allclose(RELAY[:, 35], at_points / np.linalg.norm(at_points), atol=1e-3)


def test_a_half_cycle_is_cut_between_samples_and_loses_its_sign():
    samples = np.arange(-0.3, 21.0)
    half = resampled(-np.sin(np.pi * samples / 20.2))
    np.testing.assert_allclose(half, np.sin(np.pi * T), atol=5e-3)


@pytest.mark.parametrize("detector", DETECTORS, ids=lambda detector: detector.name)
@pytest.mark.parametrize("noise", [0.0, 0.05])
def test_verdicts_on_sampled_waves(detector, noise):
    expected = {
        "he_curve_fit": ("no_stiction", "stiction", "undecided"),
        "rossi_scali": ("no_stiction", "stiction", "stiction"),
        "hagglund_shape": ("undecided", "undecided", "stiction"),
    }[detector.name]
    rng = np.random.default_rng(5)
    for (name, wave), verdict in zip(WAVES.items(), expected, strict=True):
        noisy = 50 + wave + noise * rng.normal(size=wave.size)
        found = detector.detect(LoopWindow(name, 0.0, 1.0, noisy, noisy), STEADY)
        assert found.verdict == verdict, found.reason


def test_he_looks_at_pv_where_the_loop_integrates_and_the_others_do_not_look():
    window = LoopWindow("x", 0.0, 1.0, WAVES["sine"], WAVES["triangle"], hints=LoopHints(integrating=True))
    assert HeCurveFit().detect(window, STEADY).verdict == "stiction"
    for other in (RossiScali(), HagglundShape()):
        result = other.detect(window, STEADY)
        assert result.verdict == "not_applicable"
        assert "integrating" in result.reason


@pytest.mark.parametrize("detector", DETECTORS, ids=lambda detector: detector.name)
def test_limits_are_checked_and_named(detector):
    wave = WAVES["triangle"]
    noise = np.random.default_rng(1).normal(size=wave.size)

    def reason(values, oscillation=STEADY, delay=None):
        window = LoopWindow("x", 0.0, 1.0, values, values, hints=LoopHints(delay=delay))
        result = detector.detect(window, oscillation)
        assert (result.verdict, result.index, result.seen) == ("not_applicable", None, None)
        return result.reason

    unknown = Oscillation(detected=False, period=None, regularity=None)
    assert "period" in reason(wave, unknown)
    assert "periods without a gap" in reason(wave[:450])
    assert "samples a period" in reason(
        wave[::12], Oscillation(detected=True, period=100 / 12, regularity=3.0)
    )
    assert "dead time" in reason(wave, delay=20)
    assert "noise" in reason(wave + 0.6 * noise)
    assert "half cycles" in reason(wave, Oscillation(detected=True, period=20.0, regularity=3.0))


def test_noise_beyond_the_limit_is_where_he_could_no_longer_recognise_a_triangle():
    noise = np.random.default_rng(2).normal(size=(400, POINTS))
    triangle = SHAPES["triangle"] / np.sqrt(1 / 3)
    at_limit = he_curve_fit.index(he_curve_fit.measures(triangle + 0.17 * noise).mean(axis=0))
    assert at_limit == pytest.approx(he_curve_fit.TRIANGLE_FROM, abs=0.02)


def test_what_the_noise_check_sees_of_a_clean_wave_with_corners_is_no_noise():
    found = RossiScali().detect(LoopWindow("x", 0.0, 1.0, WAVES["square"], WAVES["square"]), STEADY)
    assert found.verdict == "stiction"
    assert detect_oscillation(LoopWindow("x", 0.0, 1.0, WAVES["square"], WAVES["square"])).detected
