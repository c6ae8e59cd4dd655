"""A valve whose friction differs from slip to slip."""

from unittest.mock import patch

import numpy as np
import pytest

from agent.analysis.diagnose import diagnose
from agent.analysis.innovations.noise_models import noise_models
from agent.analysis.innovations.process_search import best_process
from agent.analysis.innovations.scattered_slips import with_scattered_slips
from agent.analysis.innovations.stem import StickingStem
from agent.analysis.innovations.whitened import log_likelihood
from agent.analysis.quantify.free_run.problem import pose
from agent.analysis.record.recording import LoopHints, LoopWindow
from agent.physics.valves.he2007 import he2007
from agent.report.reasons import reasons
from benchmarks.cases.random_loop import random_scenario, window_of
from benchmarks.scattered_slips import scattered
from simulators.plant import simulate

WITHOUT = patch("agent.analysis.innovations.with_scatter", lambda *_: None)
S, J = 2.0, 0.6
NOISE = 0.05


def scattered_stem(op, scatter, rng):
    """He's valve, with friction drawn anew after each slip."""
    x, factor, stem = op[0], 1.0, np.empty(len(op))
    for t, now in enumerate(op):
        if abs(now - x) > (S + J) / 2 * factor:
            x = now - np.sign(now - x) * (S - J) / 2 * factor
            factor = np.exp(scatter * rng.normal())
        stem[t] = x
    return stem


def record(seed, *, scatter=None, n=900):
    """OP that wanders in open loop, and PV behind a stem, or behind OP where the scatter is None."""
    rng = np.random.default_rng(seed)
    op = 50 + 5 * np.sin(2 * np.pi * np.arange(n) / 300) + 0.03 * np.cumsum(rng.normal(size=n))
    stem = op if scatter is None else scattered_stem(op, scatter, rng)
    pv = np.convolve(stem - op[0], 0.2 * 0.8 ** np.arange(40))[:n]
    return LoopWindow("loop", 0.0, 1.0, op, pv + NOISE * rng.normal(size=n)), stem


def compared(window, stem=None):
    """Log likelihoods without a valve, with one S, and the valve whose slips scatter."""
    whitened = noise_models(window, pose(window))
    linear = best_process(whitened, LoopHints())
    sound = log_likelihood(linear, whitened[linear.noise])
    if stem is None:
        stem = he2007(window.op, (S + J) / 2, (S - J) / 2, float(window.op[0]))
    behind = [each._replace(op=stem) for each in whitened]
    begin = StickingStem(best_process(behind, LoopHints()), behind, (S, J))
    return sound, begin.likelihood, with_scattered_slips(begin, whitened, LoopHints())


@pytest.mark.parametrize(("seed", "scatter"), [(1, 0.2), (2, 0.2), (4, 0.1)])
def test_slips_that_scatter_are_followed(seed, scatter):
    """With one S the record is 4 to 26 nats likelier than with a sound valve, with the true stem some 200."""
    window, stem = record(seed, scatter=scatter)
    sound, steady, found = compared(window)
    _, true, _ = compared(window, stem)
    assert 25 < found.stem.likelihood - steady < true - steady
    assert found.stem.likelihood - sound > 2 * (steady - sound)
    assert found.stem.bands[0] == pytest.approx(S, rel=0.3)
    assert 0.05 < found.scatter < 0.35


def test_where_one_s_explains_all_slips_their_freedom_gains_nothing():
    window, _ = record(3, scatter=0.0)
    sound, steady, found = compared(window)
    assert steady - sound > 150
    assert 30 < found.stem.likelihood - sound < steady - sound
    assert found.stem.bands[0] == pytest.approx(S, rel=0.1)


@pytest.mark.parametrize("seed", range(4, 8))
def test_noise_is_no_slip(seed):
    window, _ = record(seed)
    sound, _, found = compared(window)
    assert found is None or found.stem.likelihood - sound < 3


def test_records_whose_instants_were_lost_have_no_answer():
    window, _ = record(8, scatter=0.2, n=6200)
    whitened = noise_models(window, pose(window))
    assert whitened[0].block == 2
    fit = best_process(whitened, LoopHints())
    assert with_scattered_slips(StickingStem(fit, whitened, (S, J)), whitened, LoopHints()) is None


def test_the_verdict_and_its_reasons():
    """Of dozens of nats seven are left with one S."""
    scenario, _ = random_scenario("set_point_stiction", 3321)
    scenario = scattered(scenario, 0.3)
    window = window_of(scenario, simulate(scenario))
    found = diagnose(window)
    with WITHOUT:
        without = diagnose(window)
    assert found.verdict == "stiction"
    assert found.quantification.log_likelihood_ratio > 100
    assert without.quantification.log_likelihood_ratio < 50
    assert without.quantification.slip_scatter is None
    assert 0.15 < found.quantification.slip_scatter < 0.6
    assert any("differs from slip to slip" in each for each in reasons(found))
    assert not any("differs from slip to slip" in each for each in reasons(without))
