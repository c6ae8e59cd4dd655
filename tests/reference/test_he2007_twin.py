import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from agent.physics.valves.he2007 import he2007
from tests.reference.he2007_flow_chart import he2007_flow_chart

SEEDS = st.integers(0, 2**32 - 1)
BANDS = st.tuples(st.floats(0, 8), st.floats(0, 1)).map(lambda b: (b[0], b[0] * b[1]))


@settings(deadline=None)  # the first call compiles
@given(seed=SEEDS, bands=BANDS, stored=st.floats(-1, 1), gap=st.integers(0, 200))
def test_the_form_without_memory_is_the_published_flow_chart(seed, bands, stored, gap):
    f_s, f_d = bands
    op = np.cumsum(np.random.default_rng(seed).standard_normal(300))
    x0 = op[0] - stored * f_s
    op[gap : gap + 20] = np.nan
    slow = he2007_flow_chart(op, f_s, f_d, x0)
    np.testing.assert_allclose(he2007(op, f_s, f_d, x0), slow, rtol=0, atol=1e-12)
