"""The controller's action is read from OP and the error, in closed loop, or reported as unknown."""

import numpy as np
import pytest

from agent.analysis.loop.controller_action import process_gain_sign
from agent.analysis.record.recording import LoopHints, LoopWindow
from simulators.draws.random_plants import random_plant
from simulators.plant import simulate


def pi_loop(kc, seed=0, n=600, ti=10.0, noise=0.2, valve=lambda op: op):
    """A first-order process of gain sign(kc) under a PI controller, 1 s; the set point moves twice."""
    random = np.random.default_rng(seed)
    sp = np.where(np.arange(n) % 400 < 200, 30.0, 34.0)
    op, pv = np.empty(n), np.empty(n)
    x, integral = 30.0, 50.0
    for t in range(n):
        pv[t] = x + noise * random.standard_normal()
        error = sp[t] - pv[t]
        integral += kc * error / ti
        op[t] = integral + kc * error
        x += (30.0 + np.sign(kc) * 0.8 * (valve(op[t]) - 50.0) - x) / 8.0
    return op, pv, sp


def sign(op, pv, sp=None, acting=None):
    return process_gain_sign(LoopWindow("FIC1", 0.0, 1.0, op, pv, sp, hints=LoopHints(acting=acting)))


@pytest.mark.parametrize(("kc", "expected"), [(0.8, 1), (-0.8, -1), (0.05, 1), (-0.05, -1)])
@pytest.mark.parametrize("seed", range(3))
def test_the_sign_of_the_controller_gain_is_that_of_the_process(kc, expected, seed):
    assert sign(*pi_loop(kc, seed)) == expected


def test_a_constant_set_point_that_was_not_recorded_does_no_harm():
    op, pv, _ = pi_loop(0.8)
    assert sign(op[:200], pv[:200]) == 1


def test_a_valve_that_moves_in_steps_does_not_hide_the_controller():
    assert sign(*pi_loop(-0.8, valve=lambda op: 4 * np.round(op / 4))) == -1


def test_what_the_engineer_knows_goes_first():
    assert sign(*pi_loop(0.8), acting="direct") == -1
    assert sign(*pi_loop(-0.8), acting="reverse") == 1


def test_gaps_take_only_their_own_increments_away():
    op, pv, sp = pi_loop(-0.8)
    op[100:180] = np.nan
    pv[300::7] = np.nan
    assert sign(op, pv, sp) == -1


def test_an_op_that_has_nothing_to_do_with_the_error_gives_no_sign():
    random = np.random.default_rng(1)
    op = np.cumsum(random.standard_normal(600))
    assert sign(op, random.standard_normal(600)) == 0


@pytest.mark.parametrize(
    ("op", "pv"),
    [
        (np.full(600, 50.0), np.sin(np.arange(600.0))),
        (np.sin(np.arange(9.0)), np.cos(np.arange(9.0))),
        (np.full(600, np.nan), np.arange(600.0)),
        (np.arange(600.0), np.full(600, np.nan)),
    ],
)
def test_where_nothing_can_be_read_it_is_unknown(op, pv):
    assert sign(op, pv) == 0


@pytest.mark.parametrize("kind", ["stiction", "none_noise", "tuning", "sinusoid", "drift"])
def test_on_simulated_plants_it_is_right_or_unknown(kind):
    signs = []
    for seed in range(3):
        plant = random_plant(seed, kind)
        record = simulate(plant)
        signs.append(sign(record.op, record.pv) * (1 if plant.process.gain > 0 else -1))
    assert -1 not in signs
    assert signs.count(1) >= 2
