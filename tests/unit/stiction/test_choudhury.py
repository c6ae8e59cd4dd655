"""Apparent stiction by ellipse and by clusters, after the bicoherence."""

import numpy as np
import pytest
from scipy import signal

from agent.analysis.loop.ellipse import fit_ellipse
from agent.analysis.record.recording import LoopHints
from agent.analysis.stiction.choudhury_cmeans import ChoudhuryCmeans, clusters, fuzzy_two_means
from agent.analysis.stiction.choudhury_ellipse import LARGEST_MISFIT, ChoudhuryEllipse, OpPvEllipse
from agent.analysis.stiction.shapes.op_pv_cycles import CYCLES, Cycles, most_regular
from tests.unit.stiction.loops import detect, simulated

BOTH = pytest.mark.parametrize(
    "detector", [ChoudhuryEllipse(), ChoudhuryCmeans()], ids=lambda each: each.name
)
PERIOD = 21.7
ANGLE = 2 * np.pi * np.arange(3000) / PERIOD


def noise(seed, size=3000):
    return np.random.default_rng(seed).normal(size=size)


def sawtooth(shift):
    """A nonlinear wave, the given part of a period late."""
    return signal.sawtooth(ANGLE - 2 * np.pi * shift, 0.85)


def points(spread):
    return Cycles(*spread(np.random.default_rng(0)))


def ellipse_of(cycles):
    return OpPvEllipse(cycles, fit_ellipse(cycles.op, cycles.pv))


@pytest.mark.parametrize("lag", [0.4, 1.2])
def test_the_width_of_a_known_ellipse(lag):
    op, pv = 3 * np.sin(ANGLE) + 0.05 * noise(0), 7 * np.sin(ANGLE - lag) + 0.05 * noise(1)
    for detector, tolerance in ((ChoudhuryEllipse(), 0.05), (ChoudhuryCmeans(), 0.12)):
        result = detect(detector, op, pv, PERIOD)
        assert result.verdict == "no_stiction"  # a sine is linear
        assert result.seen.apparent == pytest.approx(2 * 3 * np.sin(lag), rel=tolerance)
        assert result.index == pytest.approx(result.seen.apparent / np.ptp(op))


@BOTH
def test_a_nonlinear_wave_with_op_and_pv_apart_is_called_stiction(detector):
    result = detect(detector, sawtooth(0.2) + 0.02 * noise(0), sawtooth(0.0) + 0.02 * noise(1), PERIOD)
    assert result.verdict == "stiction"
    assert f"{result.seen.apparent:.3g}" in result.reason


def test_without_a_width_there_is_no_stiction():
    op, pv = sawtooth(0.0), sawtooth(0.0) + 0.02 * noise(1)
    wide = LoopHints(op_range=(0.0, 100.0))
    result = detect(ChoudhuryEllipse(), op + 0.02 * noise(0), pv, PERIOD, hints=wide)
    assert result.verdict == "no_stiction"
    assert result.index < 0.01
    assert "narrow" in result.reason
    assert detect(ChoudhuryCmeans(), op + 0.02 * noise(0), pv, PERIOD, hints=wide).verdict == "no_stiction"


def test_one_cluster_is_not_two():
    slow = signal.sawtooth(ANGLE * PERIOD / 100, 0.85)
    result = detect(ChoudhuryCmeans(), slow + 0.3 * noise(0), slow + 0.02 * noise(1), 100.0)
    assert result.verdict == "undecided"
    assert "overlap" in result.reason


@BOTH
@pytest.mark.parametrize("op", [np.full(3000, 4.0), np.full(3000, 0.0)])
def test_op_that_stands_still_draws_nothing(detector, op):
    result = detect(detector, op, sawtooth(0.0) + 0.02 * noise(1), PERIOD)
    assert result.verdict == "undecided"
    assert result.index is None


def test_points_on_an_ellipse_fit_and_a_cloud_does_not():
    on_it = points(lambda rng: (np.cos(t := rng.uniform(0, 6.3, 100)), 0.2 * np.cos(t - 1)))
    assert ellipse_of(on_it).misfit < 1e-6
    for spread in (lambda rng: rng.normal(size=(2, 300)), lambda rng: rng.uniform(size=(2, 300))):
        assert ellipse_of(points(spread)).misfit > LARGEST_MISFIT


@pytest.mark.parametrize("share", [0.5, 0.3])
def test_the_distance_of_two_known_clusters(share):
    rng = np.random.default_rng(0)
    x = np.where(rng.random(400) < share, -3.0, 3.0) + 0.2 * rng.normal(size=400)
    assert fuzzy_two_means(x) == pytest.approx((-3.0, 3.0), abs=0.05)
    assert fuzzy_two_means(-x) == pytest.approx((-3.0, 3.0), abs=0.05)
    far = fuzzy_two_means(1e9 * x + 1e12)
    assert (far[1] - far[0]) / 1e9 == pytest.approx(6.0, abs=0.1)


def test_clusters_are_two_when_the_gap_is_wide():
    rng = np.random.default_rng(0)
    pv = np.where(np.arange(400) < 200, 0.0, rng.choice([-1.0, 1.0], 400))
    for op, apart in (
        (rng.choice([-3.0, 3.0], 400) + rng.normal(size=400), True),
        (rng.uniform(size=400), False),
        (rng.normal(size=400), False),
    ):
        assert clusters(Cycles(op, pv)).apart == apart


def test_nothing_to_cluster():
    pv = np.repeat([-1.0, 1.0], 50)
    assert clusters(Cycles(np.arange(100.0), pv)) is None
    assert clusters(Cycles(np.ones(100), 0 * pv + np.linspace(-1, 1, 100))) is None


def test_the_most_regular_cycles_are_taken():
    rng = np.random.default_rng(0)
    frequency = np.where(np.arange(1000) < 600, 1 + 0.5 * rng.normal(size=1000), 1.0) / 25
    found = most_regular(np.sin(2 * np.pi * np.cumsum(frequency)))
    assert found.start >= 580
    assert found.stop - found.start == pytest.approx(CYCLES * 25, abs=1)
    assert most_regular(np.sin(np.linspace(0, 8 * np.pi, 200))) is None


@BOTH
def test_simulated_loops(detector):
    assert detector.detect(*simulated("stiction", 10)[:2]).verdict == "stiction"
    assert detector.detect(*simulated("sinusoid", 10)[:2]).verdict != "stiction"
    assert detector.detect(*simulated("tuning", 10)[:2]).verdict != "stiction"
