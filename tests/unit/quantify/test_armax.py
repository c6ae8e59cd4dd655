import numpy as np
import pytest

from agent.analysis.quantify.processes.armax import fit_armax, free_run
from agent.analysis.quantify.processes.model_error import mean_squared_error
from agent.analysis.quantify.processes.output_error import FIRST_ORDER, fit_process, plausible
from agent.physics.processes.arx import Arx, simulate_arx

TRUE = Arx(0.9, 0.0, 0.15, 0.0, 0.0, 4)


def record(noise, load=0.0, n=3000):
    random = np.random.default_rng(4)
    mv = np.sign(np.sin(np.arange(n) / 15)) + 0.2 * random.standard_normal(n)
    pv = np.nan_to_num(simulate_arx(TRUE, mv, np.zeros(n))) + noise * random.standard_normal(n)
    walk = load * np.cumsum(random.standard_normal(n))
    response = np.convolve(walk, 0.9 ** np.arange(200))[:n]
    return mv - mv.mean(), pv + response - np.mean(pv + response), walk


def test_noise_on_pv_biases_plain_least_squares_and_armax_hardly():
    mv, pv, _ = record(noise=0.3)
    plain = fit_process(mv, pv, 4, FIRST_ORDER)
    armax = fit_armax(mv, pv, 4, FIRST_ORDER, 1, 0.0)
    assert plain.a1 < 0.85
    assert armax.process.a1 == pytest.approx(0.9, abs=0.015)
    assert armax.process.b1 == pytest.approx(0.15, abs=0.02)
    assert armax.c1 == pytest.approx(-0.9, abs=0.05), "noise on PV stands in an ARMAX as c = -a"


def test_eta_is_the_walking_load():
    mv, pv, load = record(noise=0.01, load=0.01)
    found = fit_armax(mv, pv, 4, FIRST_ORDER, 1, 0.5)
    assert np.corrcoef(found.eta, load)[0, 1] > 0.95
    assert mean_squared_error(free_run(found, mv, pv), pv) < 0.02 * np.var(pv)


def test_a_valve_that_never_moves_has_no_model():
    _, pv, _ = record(noise=0.1)
    found = fit_armax(np.zeros(len(pv)), pv, 4, FIRST_ORDER, 1, 0.0)
    assert not plausible(found.process, 0)
    assert found.aic == np.inf
