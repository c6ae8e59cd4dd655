import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from agent.physics.valves.damped_stem import AT_ONCE, damped_stem, damped_stem_by_direction
from agent.physics.valves.he2007 import he2007
from agent.physics.valves.two_state import two_state
from tests.reference.damped_stem_branches import by_direction_in_small_steps, damped_stem_in_small_steps

SEEDS = st.integers(0, 2**32 - 1)
T = np.arange(120)
GAP = slice(60, 75)


def oscillation(seed):
    """A slow OP, so that the stem seldom has to rest and break away in one sample, with a gap."""
    random = np.random.default_rng(seed)
    op = 6 * np.sin(2 * np.pi * T / random.uniform(30, 60) + random.uniform(0, 6))
    op += random.uniform(0, 2) * np.sin(2 * np.pi * T / random.uniform(12, 25) + random.uniform(0, 6))
    op += 0.05 * random.standard_normal(T.size)
    op[GAP] = np.nan
    return op


def walk(seed):
    random = np.random.default_rng(seed)
    op = np.cumsum(random.standard_normal(300) * (random.random(300) > 0.3))
    op[100:120] = np.nan
    return op


def worst_difference(seed):
    random = np.random.default_rng(1000 + seed)
    f_s = random.uniform(2, 5)
    f_d = f_s * random.uniform(0, 0.5)
    stem = random.uniform(0.1, 1.5), random.uniform(0.05, 0.5), random.uniform(0, 0.3)
    op = oscillation(seed)
    solved = damped_stem(op, f_s, f_d, op[0], *stem)
    assert np.ptp(solved[GAP]) == 0
    return np.abs(solved - damped_stem_in_small_steps(op, f_s, f_d, op[0], *stem)).max()


def test_records_are_those_of_small_steps_but_where_a_threshold_is_grazed():
    worst = np.array([worst_difference(seed) for seed in range(40)])
    assert np.median(worst) < 0.02
    assert np.quantile(worst, 0.85) < 0.15  # OP units of about ten


@settings(deadline=None)  # the first call compiles
@given(
    over=st.floats(1.05, 1.3),
    kinetic=st.floats(0, 0.5),
    damping=st.floats(0.1, 2),
    supply=st.floats(0.05, 0.8),
    rest=st.floats(0, 0.3),
    upward=st.booleans(),
)
def test_a_slip_takes_the_course_of_small_steps(over, kinetic, damping, supply, rest, upward):
    f_s, f_d = 5.0, 5.0 * kinetic
    op = np.r_[0.0, np.full(5, over * f_s)] * (1 if upward else -1)
    np.testing.assert_allclose(
        damped_stem(op, f_s, f_d, 0.0, damping, supply, rest),
        damped_stem_in_small_steps(op, f_s, f_d, 0.0, damping, supply, rest),
        rtol=0,
        atol=0.2,
    )


@settings(deadline=None)
@given(
    over=st.floats(0.5, 1.3),
    before=st.floats(-0.3, 0.4),
    kinetic=st.floats(0, 0.5),
    supply=st.floats(0.05, 0.8),
    give=st.floats(0.01, 0.5),
    upward=st.booleans(),
)
def test_bristles_break_away_as_in_small_steps(over, before, kinetic, supply, give, upward):
    f_s, f_d = 5.0, 5.0 * kinetic
    op = np.r_[0.0, np.full(8, before * f_s), np.full(5, over * f_s)] * (1 if upward else -1)
    stem = 0.4, supply, 0.05, give
    exact = damped_stem(op, f_s, f_d, 0.0, *stem)
    small = damped_stem_in_small_steps(op, f_s, f_d, 0.0, *stem)
    grazed = (exact[-1] == 0) != (small[-1] == 0)
    if grazed:  # where the least more force would have taken it away
        nearly = [damped_stem(op * k, f_s, f_d, 0.0, *stem)[-1] == 0 for k in (0.99, 1.01)]
        assert nearly == [True, False]
    else:
        np.testing.assert_allclose(exact, small, rtol=0, atol=0.2)


@settings(deadline=None)
@given(seed=SEEDS, f_s=st.floats(0.5, 8), give=st.floats(0, 0.5))
def test_bristles_that_cannot_jump_are_stiff(seed, f_s, give):
    op, stem = walk(seed), (0.3, 0.2, 0.02)
    stiff = damped_stem(op, f_s, f_s, op[0], *stem)
    np.testing.assert_array_equal(damped_stem(op, f_s, f_s, op[0], *stem, give), stiff)


@settings(deadline=None)
@given(
    over=st.floats(1.05, 1.3),
    other=st.floats(2, 3),
    kinetic=st.floats(0, 0.5),
    damping=st.floats(0.1, 2),
    rest=st.floats(0, 0.3),
    upward=st.booleans(),
)
def test_each_direction_slips_by_its_own_static_friction(over, other, kinetic, damping, rest, upward):
    f_s, f_d = 5.0, 5.0 * kinetic
    # A jump hardly more than the force at rest would come in many small ones, of which a sample has one.
    assume(rest * (other * f_s - f_d) <= 0.5 * (f_s - f_d))
    bands = (f_s, other * f_s, f_d) if upward else (other * f_s, f_s, f_d)
    sign = 1 if upward else -1
    op = sign * np.r_[0.0, np.full(5, over * f_s), np.full(5, (1.35 - other) * f_s)]
    position = damped_stem_by_direction(op, *bands, 0.0, damping, 0.2, rest)
    small = by_direction_in_small_steps(op, *bands, 0.0, damping, 0.2, rest)
    np.testing.assert_allclose(position[:6], small[:6], rtol=0, atol=0.2)
    # Where it still slides when the force turns, it may go back by a part of the last slide.
    least = sign * position[5] - 1e-3 * f_s
    assert sign * position[-1] >= least, "the other direction has twice the friction"


@settings(deadline=None)
@given(seed=SEEDS, f_s=st.floats(0.1, 8), kinetic=st.floats(0, 0.9), rest=st.floats(1e-6, 1))
def test_a_stem_without_lags_is_hes_valve_that_stops_short(seed, f_s, kinetic, rest):
    op, f_d = walk(seed), f_s * kinetic
    lag = 0.2 * AT_ONCE
    np.testing.assert_allclose(
        damped_stem(op, f_s, f_d, op[0], lag, lag, rest),
        he2007(op, f_s, f_d + rest * (f_s - f_d), op[0]),
        rtol=0,
        atol=1e-9,
    )


@settings(deadline=None)
@given(period=st.floats(40, 120), f_s=st.floats(1.5, 6), kinetic=st.floats(0, 0.9))
def test_a_stem_that_never_rests_is_the_two_state_valve(period, f_s, kinetic):
    # OP goes less than f_S in a sample, so the stem need not turn within one.
    op = 8 * np.sin(2 * np.pi * T / period + 1)
    op[GAP] = np.nan
    position = damped_stem(op, f_s, f_s * kinetic, op[0], 0.03, 0.01, 0.0)
    np.testing.assert_allclose(position, two_state(op, f_s, f_s * kinetic, op[0]), rtol=0, atol=1e-3)


@pytest.mark.parametrize("missing", [0, 1, 7])
def test_after_a_gap_the_actuator_starts_from_the_new_op(missing):
    op = np.r_[np.full(missing, np.nan), np.full(5, 6.0)]
    position = damped_stem(op, 5.0, 2.0, 0.0, 0.3, 1.0, 0.0)
    assert np.all(position[:missing] == 0)
    assert position[missing] == pytest.approx(4 * (1 - 0.3 * (1 - np.exp(-1 / 0.3))))
