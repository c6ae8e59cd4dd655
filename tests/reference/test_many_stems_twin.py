"""Stems side by side against the same stems one by one."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from agent.lanes import WIDTH
from agent.physics.valves.damped_stem import DAMPING, GIVE, REST, SUPPLY, damped_stem
from agent.physics.valves.many_stems import VALUES, move_stems
from tests.reference.damped_stem_branches import damped_stem_in_small_steps

SEEDS = st.integers(0, 2**32 - 1)
CLOSE = 1e-9
"""OP units of about ten; rounding is far below, a slip that is missed far above."""


def op_of(random, n=400):
    t = np.arange(n)
    op = 6 * np.sin(2 * np.pi * t / random.uniform(20, 80) + random.uniform(0, 6))
    return op + random.choice([0.0, 0.05, 0.5]) * random.standard_normal(n)


def valves_of(random):
    """Valves of every kind: wide and narrow bands, quick and slow stems, stiff and soft bristles."""
    valves = np.empty((VALUES, WIDTH))
    s = random.uniform(0.1, 8, WIDTH)
    j = s * random.choice([0.0, 1.0, random.uniform()], WIDTH)
    logarithmic = [np.exp(random.uniform(*np.log(each), WIDTH)) for each in (DAMPING, SUPPLY, REST)]
    give = np.exp(random.uniform(*np.log(GIVE), WIDTH)) * (random.random(WIDTH) < 0.4)
    valves[:] = (s + j) / 2, (s - j) / 2, random.uniform(-6, 6, WIDTH), *logarithmic, give
    at_once = random.random(WIDTH) < 0.2
    valves[3:6, at_once] = [[0.01], [0.01], [1e-8]]
    valves[4, random.integers(WIDTH)] = valves[3, random.integers(WIDTH)]
    return valves


@given(SEEDS)
def test_each_lane_is_its_stem_alone(seed):
    random = np.random.default_rng(seed)
    op, valves = op_of(random), valves_of(random)
    positions = np.empty((op.size, WIDTH))
    move_stems(op, valves, positions)
    alone = np.stack([damped_stem(op, *valves[:, lane]) for lane in range(WIDTH)], axis=1)
    np.testing.assert_allclose(positions, alone, rtol=0, atol=CLOSE)


def test_a_lane_does_not_depend_on_its_neighbours():
    random = np.random.default_rng(5)
    op, valves = op_of(random), valves_of(random)
    positions, repeated = np.empty((2, op.size, WIDTH))
    move_stems(op, valves, positions)
    for lane in range(WIDTH):
        move_stems(op, np.repeat(valves[:, lane : lane + 1], WIDTH, axis=1), repeated)
        np.testing.assert_array_equal(repeated[:, 0], positions[:, lane])


def test_a_stem_that_comes_to_rest_breaks_away_again_while_the_air_still_comes():
    """It rests within a sample and the force goes on; at the next one OP has turned, the force has not."""
    op = np.array([0.0, -2.6, -2.8, -2.6, -2.6, -2.6])
    stem = 2.0, 1.8, 0.0, 0.06, 0.5, 0.3
    exact = damped_stem_in_small_steps(op, *stem, steps=20_000)
    assert damped_stem(op, *stem)[-1] == pytest.approx(exact[-1], abs=0.1)  # 0.15 off if it is not seen
