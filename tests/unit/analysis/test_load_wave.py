"""A load that goes on as one wave is no limit cycle of a valve."""

import numpy as np
import pytest

from agent.analysis.diagnose import diagnose
from agent.analysis.innovations.load_wave import _highest, with_load_wave
from agent.analysis.innovations.noise_models import noise_models
from agent.analysis.innovations.process_search import best_process
from agent.analysis.innovations.whitened import log_likelihood
from agent.analysis.quantify.free_run.problem import pose
from agent.analysis.record.recording import LoopHints, LoopWindow
from agent.report.reasons import LOAD_WAVE, reasons
from simulators.draws.hidden_effects import hidden_effect_plant

PRICE = 20.0
"""Nats that frequency, amplitude and phase cost at most in 600 samples, beside what chance takes off them."""


def window_of(seed, truth):
    plant = hidden_effect_plant(seed, truth)
    return LoopWindow(truth, 0.0, plant.scenario.ts, plant.op, plant.pv, plant.sp)


@pytest.mark.parametrize("seed", [98315, 98320])
def test_a_load_that_oscillates_accuses_no_sound_valve(seed):
    """With p = 0.93 and 0.97 without the rival: a dead band turns this OP into this PV as well."""
    found = diagnose(window_of(seed, "sinusoid"))
    assert found.verdict != "stiction"
    assert found.quantification.log_likelihood_ratio < 5
    assert found.quantification.load_wave == (LOAD_WAVE in reasons(found))


def test_a_valve_that_sticks_beside_such_a_load_is_found():
    found = diagnose(window_of(98344, "stiction_sinusoid"))
    assert found.verdict == "stiction"
    assert found.quantification.log_likelihood_ratio > 30


@pytest.mark.parametrize("cycles", [3.4, 37.26, 200.5])
def test_the_highest_line_is_found_between_the_points_of_the_spectrum(cycles):
    m = 600
    left = np.cos(2 * np.pi * cycles * np.arange(m) / m + 1) + 0.1 * np.random.default_rng(1).normal(size=m)
    weight = np.ones(m)
    weight[100:130] = 0.0
    assert _highest(left, weight) * m == pytest.approx(cycles, abs=0.05)


def test_where_no_load_oscillates_a_wave_is_not_worth_its_numbers():
    rng = np.random.default_rng(2)
    op = 50 + np.repeat(rng.uniform(-5, 5, 30), 20)
    pv = np.convolve(op - 50, 0.1 * 0.9 ** np.arange(60))[: len(op)] + 0.3 * rng.normal(size=len(op))
    window = LoopWindow("loop", 0.0, 1.0, op, pv)
    whitened = noise_models(window, pose(window))
    linear = best_process(whitened, LoopHints())
    gained = with_load_wave(linear, whitened, LoopHints()) - log_likelihood(linear, whitened[linear.noise])
    assert -PRICE < gained < 3
