"""The damped stem with bristles breaks away where LuGre's does when OP makes a step."""

import math

import numpy as np
import pytest

from agent.physics.valves.damped_stem import damped_stem
from simulators.friction import Actuator, StemParameters, stroke

STIFFNESS, STRIBECK, DAMPING = 1e4, 0.02, 0.3
STEP = 2e-4  # s, of LuGre's integration
HOLD = 20  # samples for the force to rise slowly


def lugre_moves(f_s, f_d, supply, before, after):
    """Whether a stem moved on by LuGre from 0 breaks away when OP, held at ``before``, becomes ``after``."""
    stem = StemParameters(f_s, f_d, f_s, f_d, 2.6e-5, DAMPING, STRIBECK, 1e-3, STIFFNESS, 0.1)
    actuator = Actuator(stem, True, supply, math.inf, -1e9, 1e9)
    state = np.zeros(4)
    for op in np.append(np.linspace(0, before, 4 * HOLD), [before, after, after]):
        stroke(state, float(op), round(1 / STEP), STEP, actuator)
    return state[1] > 0.2 * (f_s - f_d)


def bristles_move(f_s, f_d, supply, before, after, give):
    op = np.append(np.linspace(0, before, 4 * HOLD), [before, after, after])
    return damped_stem(op, f_s, f_d, 0.0, DAMPING, supply, 0.01, give)[-1] > 0.2 * (f_s - f_d)


def early(moves, f_s, step):
    """By how much less than f_S takes a stem away in a step of OP, over f_S."""
    low, high = 0.4 * f_s, 1.05 * f_s
    for _ in range(12):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if moves(middle - step, middle) else (middle, high)
    return 1 - high / f_s


@pytest.mark.parametrize(("f_s", "f_d"), [(3.0, 0.15), (5.0, 1.7), (9.0, 0.5)])
@pytest.mark.parametrize("supply", [0.12, 0.25])
def test_a_step_takes_a_stem_away_below_f_s(f_s, f_d, supply):
    step = 0.1 * f_s
    give = (f_s / STIFFNESS) / (2 * STRIBECK * supply)
    by_lugre = early(lambda *op: lugre_moves(f_s, f_d, supply, *op), f_s, step)
    by_bristles = early(lambda *op: bristles_move(f_s, f_d, supply, *op, give), f_s, step)
    by_stiff = early(lambda *op: bristles_move(f_s, f_d, supply, *op, 0.0), f_s, step)
    assert abs(by_stiff) < 0.001
    assert by_lugre > 0.002
    assert by_bristles == pytest.approx(by_lugre, rel=0.35, abs=0.002)  # to leading order
