import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from agent.physics.valves.two_state import two_state
from tests.reference.two_state_branches import two_state_branches

SEEDS = st.integers(0, 2**32 - 1)
BANDS = st.tuples(st.floats(0, 8), st.floats(0, 1)).map(lambda b: (b[0], b[0] * b[1]))


@settings(deadline=None)  # the first call compiles
@given(seed=SEEDS, bands=BANDS, stored=st.floats(-1, 1), gap=st.integers(0, 200), rests=st.booleans())
def test_the_kernel_is_the_branches(seed, bands, stored, gap, rests):
    f_s, f_d = bands
    random = np.random.default_rng(seed)
    op = np.cumsum(random.standard_normal(300) * (random.random(300) > 0.3 if rests else 1))
    x0 = op[0] - stored * f_s
    op[gap : gap + 20] = np.nan
    np.testing.assert_allclose(
        two_state(op, f_s, f_d, x0), two_state_branches(op, f_s, f_d, x0), rtol=0, atol=1e-12
    )
