"""Few samples a period: no firm verdict, intervals that know what happens within a sample."""

from __future__ import annotations

import numpy as np
import pytest

from agent.analysis.diagnose import diagnose
from agent.analysis.evidence.weighing import MOST, MOST_OF_COARSE, most_log_odds
from agent.analysis.gates.fast_line import fast_line
from agent.analysis.quantify.free_run.intervals import hidden_movement
from agent.analysis.record.recording import LoopWindow
from agent.report.diagnosis_json import diagnosis_json

N = 400


def triangle(rate, n=N):
    """Triangle wave of ``rate`` samples a period, with a period that varies a little."""
    rng = np.random.default_rng(3)
    phase = np.cumsum(1 / rate + 0.02 / rate * rng.standard_normal(n))
    return 4 * np.abs(phase % 1 - 0.5) - 1


@pytest.mark.parametrize("rate", [2.7, 4, 4.4, 5, 6, 8, 10, 11.5])
def test_few_samples_a_period_give_no_verdict_whether_the_detectors_see_them_or_not(rate):
    rng = np.random.default_rng(4)
    op = 50 + triangle(rate) + 0.02 * rng.standard_normal(N)
    pv = 20 + np.roll(triangle(rate), 1) + 0.02 * rng.standard_normal(N)
    found = diagnose(LoopWindow("L", 0.0, 1.0, op, pv))
    assert (found.verdict, found.probability) == ("not_testable", None)
    assert "coarse" in found.gates
    assert diagnosis_json(found, "L.csv")["samples_per_period"] == pytest.approx(rate, rel=0.1)


@pytest.mark.parametrize("seed", range(5))
def test_noise_and_walks_have_no_line(seed):
    noise = np.random.default_rng(seed).standard_normal(N)
    for values in (noise, np.zeros(N), np.full(N, np.nan), noise[:10]):
        assert fast_line(values) is None
    assert (fast_line(np.cumsum(noise)) or N) > 12


def test_a_line_is_found_beside_gaps_and_a_ramp():
    values = triangle(4) + np.arange(N) / 10
    values[50:90] = np.nan
    assert fast_line(values) == pytest.approx(4, rel=0.1)


@pytest.mark.parametrize(("period", "noise"), [(12, 0.0), (50, 0.0), (200, 0.0), (200, 0.3)])
def test_what_op_moves_between_samples_widens_intervals(period, noise):
    rng = np.random.default_rng(6)
    op = triangle(period) + noise * rng.standard_normal(N)
    op[100:200] = np.nan
    op[300:500] = op[300]
    window = LoopWindow("L", 0.0, 1.0, op, np.roll(triangle(20), 3))
    movement = np.ptp(triangle(period)) * 2 / period
    noisy = 0.95 * noise  # median of |a - b| of two normal numbers
    assert hidden_movement(window) == pytest.approx(max(movement, noisy), rel=0.1)


def test_a_record_of_every_scan_hides_nothing():
    error = np.random.default_rng(7).standard_normal(N)
    op = 0.5 * error + 0.1 * np.cumsum(error)
    assert hidden_movement(LoopWindow("L", 0.0, 1.0, op, -error)) == 0.0
    assert hidden_movement(LoopWindow("L", 0.0, 1.0, np.round(op, 1), -error)) > 0.0


def test_the_probability_of_a_coarse_record_is_not_near_0_or_1():
    assert most_log_odds(12.0) == MOST_OF_COARSE == most_log_odds(4.0)
    assert most_log_odds(21.0) == pytest.approx((MOST + MOST_OF_COARSE) / 2)
    assert most_log_odds(30.0) == most_log_odds(500.0) == most_log_odds(None) == MOST
