import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from agent.physics.valves.damped_stem import damped_stem
from agent.physics.valves.he2007 import he2007
from agent.physics.valves.two_state import two_state
from tests.reference.damped_stem_branches import damped_stem_branches

SEEDS = st.integers(0, 2**32 - 1)
BANDS = st.tuples(st.floats(0, 8), st.floats(0, 1)).map(lambda b: (b[0], b[0] * b[1]))


def command(seed, gap):
    random = np.random.default_rng(seed)
    op = np.cumsum(random.standard_normal(300) * (random.random(300) > 0.3))
    op[gap : gap + 20] = np.nan
    return op


@settings(deadline=None)  # the first call compiles
@given(seed=SEEDS, bands=BANDS, gap=st.integers(1, 200), lag=st.floats(0, 0.6), rest=st.floats(0, 3))
def test_the_kernel_is_the_branches(seed, bands, gap, lag, rest):
    op = command(seed, gap)
    np.testing.assert_allclose(
        damped_stem(op, *bands, op[0], lag, rest),
        damped_stem_branches(op, *bands, op[0], lag, rest),
        rtol=0,
        atol=1e-9,
    )


@settings(deadline=None)
@given(seed=SEEDS, bands=BANDS, gap=st.integers(1, 200))
def test_its_limits_are_hes_valve_and_the_two_state_one(seed, bands, gap):
    op = command(seed, gap)
    for model, rest in ((he2007, np.inf), (two_state, 0.0)):
        np.testing.assert_allclose(
            damped_stem(op, *bands, op[0], 0.0, rest), model(op, *bands, op[0]), rtol=0, atol=1e-9
        )
