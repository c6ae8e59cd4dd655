import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from agent.physics.bases import BASES
from agent.physics.bases.linear_process import LinearProcess
from agent.physics.bases.losing_process import held
from agent.physics.effect import Facts
from agent.physics.effects.deadband import backlash
from agent.physics.effects.rate_limit import slewed
from agent.physics.loop_model import LoopModel
from tests.reference.effect_twins import (
    backlash_branches,
    held_in_small_steps,
    process_step_response,
    slewed_branches,
)
from tests.reference.process_superposition import STEP_RESPONSES, summed_steps, superposition

SEEDS = st.integers(0, 2**32 - 1)
DELAYS = st.one_of(st.floats(1, 30), st.integers(1, 30).map(float))
TS = 2.0


def walk(seed, n=120):
    random = np.random.default_rng(seed)
    return 50 + np.cumsum(random.standard_normal(n) * (random.random(n) > 0.3))


@settings(deadline=None)  # the first call compiles
@given(seed=SEEDS, width=st.floats(0, 8), place=st.floats(-1, 1))
def test_backlash_is_pushed_by_the_edges(seed, width, place):
    command = walk(seed)
    x0 = command[0] + place * width / 2
    np.testing.assert_allclose(
        backlash(command, width, x0), backlash_branches(command, width, x0), rtol=0, atol=1e-12
    )


@settings(deadline=None)
@given(seed=SEEDS, step=st.floats(0, 5))
def test_a_limited_rate_follows_as_fast_as_it_may(seed, step):
    command = walk(seed)
    np.testing.assert_allclose(slewed(command, step), slewed_branches(command, step), rtol=0, atol=1e-12)


def test_nothing_is_slewed_to_nothing():
    assert slewed(np.empty(0), 1.0).shape == (0,)


@pytest.mark.parametrize("curvature", [-0.04, -1e-9, 1e-9, 0.04])
@settings(deadline=None, max_examples=5)
@given(seed=SEEDS, tau=st.floats(1, 30))
def test_a_vessel_holds_what_its_balance_says(curvature, seed, tau):
    inputs = 18 * np.sin(walk(seed, 40) / 3)
    inputs -= inputs[0]
    inputs *= 20 / np.abs(inputs).max()
    expected = held_in_small_steps(inputs, tau, curvature)
    np.testing.assert_allclose(held(inputs, tau, curvature), expected, rtol=0, atol=0.02)


@pytest.mark.parametrize("name", STEP_RESPONSES)
@settings(deadline=None, max_examples=20)
@given(seed=SEEDS, lags=st.tuples(st.floats(0.2, 8), st.floats(9, 100)), delay=DELAYS)
def test_a_linear_base_is_the_sum_of_steps(name, seed, lags, delay):
    """Times of a base are in s; an integrator is counted from the mean position, which makes a ramp."""
    base = next(each for each in BASES if each.name == name)
    position = walk(seed, 50)
    facts = Facts(TS, 50, position.min(), position.max(), 0, 1, 20 * TS, 0.1, 1)
    lags = lags[: len(base.parameters(facts)) - 1]
    values = TS * np.array([delay, *lags])
    columns = LoopModel(base).columns(position, values, facts)
    expected = np.array(superposition(name, position, *lags, delay=delay))
    if name == "integrator":
        elapsed = np.maximum(np.arange(50) - (delay - 1), 0)
        expected = TS * (expected + (position[0] - position.mean()) * elapsed)
    np.testing.assert_allclose(columns, expected[:, np.newaxis], rtol=0, atol=1e-8)


@pytest.mark.parametrize("lags", [(7.0,), (2.5, 7.0)])
@settings(deadline=None, max_examples=20)
@given(seed=SEEDS, lead=st.floats(0, 10), delay=st.integers(1, 20).map(float))
def test_the_first_move_the_wrong_way_is_the_sum_of_steps(lags, seed, lead, delay):
    position = walk(seed, 50)
    process = LinearProcess(TS * delay, tuple(TS * lag for lag in lags), lead=TS * lead)
    expected = summed_steps(process_step_response(lags, lead, integrates=False), position, delay)
    np.testing.assert_allclose(process.respond(position, TS), expected, rtol=0, atol=1e-8)


@pytest.mark.parametrize("integrates", [False, True])
def test_three_lags_and_those_behind_an_integrator_are_the_sum_of_steps_closely(integrates):
    lags, delay, lead = (2.0, 4.0, 11.0), 3.0, 1.5
    position = 50 + np.where(np.arange(60) < 10, 0.0, 4.0)
    process = LinearProcess(TS * delay, tuple(TS * lag for lag in lags), integrates, TS * lead)
    expected = np.array(summed_steps(process_step_response(lags, lead, integrates), position, delay))
    response = process.respond(position, TS)
    if integrates:
        at_rest = LinearProcess(TS * delay, process.lags, integrates, process.lead)
        elsewhere = at_rest.respond(np.append(position, 2 * position[0] - position), TS)[:60]
        response, expected = elsewhere, TS * expected
    assert np.abs(response - expected).max() < 0.003 * np.ptp(expected)
