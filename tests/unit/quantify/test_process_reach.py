"""What a record leaves open of a process behind a known path of the valve."""

import numpy as np
import pytest

from agent.analysis.quantify.free_run.problem import pose
from agent.analysis.quantify.free_run.process_reach import process_reach
from agent.analysis.record.recording import LoopWindow
from agent.identify.objective import FOPDT, INTEGRATOR, LOG_TAU
from agent.identify.search.linear import best_linear
from agent.physics.bases.linear_process import lagged

TAU, GAIN, P = 6.0, 2.0, 0.1


def record(noise, seed, samples=900):
    """A loop whose valve follows OP, which swings with a period of 40 samples and little else."""
    rng, t = np.random.default_rng(seed), np.arange(samples)
    op = 50 + 3 * np.sin(2 * np.pi * t / 40) + 0.3 * lagged(rng.standard_normal(samples), 3.0)
    late = np.concatenate((np.full(3, op[0]), op[:-3]))
    pv = 20 + GAIN * lagged(late, TAU) + noise * rng.standard_normal(samples)
    return LoopWindow("loop", 0.0, 1.0, op, pv)


def fitted(noise, seed):
    problem = pose(record(noise, seed))
    return best_linear(problem, (FOPDT,)), problem


def test_it_grows_with_the_noise():
    quiet, loud = (process_reach(*fitted(noise, 0), P) for noise in (0.02, 0.2))
    assert set(quiet) == {"gain", "delay", "tau"}
    for name in quiet:
        assert loud[name] == pytest.approx(10 * quiet[name], rel=0.5)


def test_it_holds_the_true_time_constant_as_often_as_it_states():
    held = 0
    for seed in range(40):
        model, problem = fitted(0.2, seed)
        held += abs(model.candidate[LOG_TAU] - np.log(TAU)) <= process_reach(model, problem, P)["tau"]
    assert 32 <= held <= 40


def test_it_is_no_more_than_the_range_of_the_search():
    """PV is noise alone."""
    window = record(0.0, 1)
    window = LoopWindow("loop", 0.0, 1.0, window.op, np.random.default_rng(2).standard_normal(900))
    problem = pose(window)
    model = best_linear(problem, (INTEGRATOR,))
    reach = process_reach(model, problem, P)
    assert set(reach) == {"gain", "delay"}
    assert reach["gain"] == 1.0
    assert 0 < reach["delay"] <= problem.max_delay
