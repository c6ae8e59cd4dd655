"""The areas before and after the peaks, on waves whose ratio is known."""

import numpy as np
import pytest

from agent.analysis.record.recording import LoopHints
from agent.analysis.stiction.singhal_salsbury import SinghalSalsbury, peak_areas
from tests.unit.stiction.loops import detect, simulated

PERIOD = 200.0


def bent(peak, n=4000):
    """Half cycles of straight lines whose peak comes after the given part of them."""
    place = (2 * np.arange(n) / PERIOD) % 1
    sign = np.where((2 * np.arange(n) / PERIOD) % 2 < 1, 1.0, -1.0)
    return sign * np.where(place < peak, place / peak, (1 - place) / (1 - peak))


@pytest.mark.parametrize("peak", [0.3, 0.5, 0.7, 0.8])
def test_the_ratio_of_a_triangle_is_about_that_of_its_sides(peak):
    seen = peak_areas(bent(peak), PERIOD)
    assert seen.mean == pytest.approx(peak / (1 - peak), rel=0.3)  # smoothing draws sharp peaks to the middle
    assert np.sign(np.log(seen.mean)) == np.sign(peak - 0.5) or peak == 0.5
    assert seen.low <= seen.mean <= seen.high
    assert len(seen.peaks) == len(seen.half_cycles) == len(seen.ratios)


@pytest.mark.parametrize(
    ("peak", "verdict"), [(0.3, "no_stiction"), (0.5, "no_stiction"), (0.75, "stiction")]
)
def test_the_rule(peak, verdict):
    assert detect(SinghalSalsbury(), np.zeros(4000), bent(peak), PERIOD).verdict == verdict


def test_a_sine_is_symmetric():
    wave = np.sin(2 * np.pi * np.arange(2000) / PERIOD)
    assert peak_areas(wave, PERIOD).mean == pytest.approx(1.0, abs=0.02)


def test_peaks_that_scatter_decide_nothing():
    rng = np.random.default_rng(3)
    half = int(PERIOD / 2)
    halves = [(-1) ** k * bent(peak)[:half] for k, peak in enumerate(rng.uniform(0.1, 0.9, 40))]
    result = detect(SinghalSalsbury(), np.zeros(4000), np.concatenate(halves), PERIOD)
    assert result.verdict == "undecided"


@pytest.mark.parametrize(
    ("n", "period", "integrating", "reason"),
    [
        (4000, PERIOD, True, "integrating"),
        (900, PERIOD, False, "5 periods"),
        (4000, 15.0, False, "samples a period"),
    ],
)
def test_its_limits(n, period, integrating, reason):
    wave = np.sin(2 * np.pi * np.arange(n) / period)
    hints = LoopHints(integrating=integrating)
    assert reason in detect(SinghalSalsbury(), wave, wave, period, hints=hints).reason


def test_simulated_loops():
    """Most of forty sticking loops are seen; see docs/methods/singhal_salsbury.md for all of them."""
    seeds = [seed for seed in range(4) if not simulated("stiction", seed)[0].hints.integrating]
    verdicts = [SinghalSalsbury().detect(*simulated("stiction", seed)[:2]).verdict for seed in seeds]
    assert len(seeds) >= 2
    assert verdicts.count("stiction") >= len(seeds) - 1
    assert SinghalSalsbury().detect(*simulated("sinusoid", 0)[:2]).verdict != "stiction"
