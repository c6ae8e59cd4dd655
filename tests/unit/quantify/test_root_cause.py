import math

import numpy as np
import pytest

from agent.analysis.loop.pi_controller import PiController, pi_controller
from agent.analysis.quantify import quantifier
from agent.analysis.quantify.root_cause import own_swing
from agent.analysis.record.recording import LoopWindow
from agent.physics.processes.arx import Arx
from simulators.draws.random_plants import random_plant
from simulators.plant import simulate

PROCESS = Arx(0.9, 0.0, 0.2, 0.0, 0.0, 5)


def closed_loop(process, controller, n=2000, noise=0.1, push=0.0):
    random = np.random.default_rng(0)
    pv, op = np.zeros(n), np.zeros(n)
    for t in range(process.delay + 2, n):
        forced = process.b1 * op[t - process.delay] + process.b2 * op[t - process.delay - 1]
        pv[t] = process.a1 * pv[t - 1] + process.a2 * pv[t - 2] + forced + noise * random.standard_normal()
        pv[t] += push if t == 10 else 0.0
        op[t] = op[t - 1] - controller.kc * (pv[t] - pv[t - 1]) - controller.ki * pv[t]
    return LoopWindow("closed", 0.0, 1.0, op, pv)


def test_the_poles_give_the_oscillation_that_a_simulation_shows():
    process, controller = Arx(1.2, -0.25, 0.05, 0.02, 0.0, 5), PiController(2.6, 0.05, 1.0)
    period, left = own_swing(process, controller)
    pv = closed_loop(process, controller, n=400, noise=0.0, push=1.0).pv
    speed = np.diff(pv)  # what a slow pole adds to PV it hardly adds to this
    tops = [t for t in range(40, 200) if speed[t - 1] < speed[t] > speed[t + 1]]
    assert np.mean(np.diff(tops)) == pytest.approx(period, rel=0.03)
    assert (speed[tops[-1]] / speed[tops[0]]) ** (1 / (len(tops) - 1)) == pytest.approx(left, rel=0.05)


def test_a_loop_without_a_swing_has_none():
    assert own_swing(Arx(0.5, 0.0, 0.1, 0.0, 0.0, 1), PiController(0.05, 0.001, 1.0)) == (math.inf, 0.0)


def test_the_controller_is_read_from_the_record():
    found = pi_controller(closed_loop(PROCESS, PiController(0.4, 0.05, 1.0)))
    assert (found.kc, found.ki) == pytest.approx((0.4, 0.05), rel=1e-3)
    assert found.explained > 0.99


@pytest.mark.parametrize(
    ("kind", "cause"), [("tuning", "tight_tuning"), ("sinusoid", "external_disturbance")]
)
def test_the_cause_of_an_oscillation_without_stiction_is_named(kind, cause):
    record = simulate(random_plant(3, kind))
    found = quantifier("karra_karim2009").quantify(LoopWindow(kind, 0.0, 1.0, record.op, record.pv))
    assert found.cause_shares[0].cause == cause
    assert sum(each.share for each in found.cause_shares) == pytest.approx(1.0)
