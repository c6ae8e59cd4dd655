import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from agent.analysis.quantify.processes.armax import fit_armax
from agent.analysis.quantify.processes.output_error import FIRST_ORDER, INTEGRATOR, SECOND_ORDER
from tests.reference.armax_by_hand import armax

DELAY = 3


def loop(seed):
    """A first-order process with noise on PV and a walking load; OP and PV have gaps."""
    random = np.random.default_rng(seed)
    n = 60
    mv = np.sin(np.arange(n) / 4) + 0.5 * random.standard_normal(n)
    load = 0.05 * np.cumsum(random.standard_normal(n))
    pv = np.zeros(n)
    for t in range(DELAY, n):
        pv[t] = 0.8 * pv[t - 1] + 0.5 * mv[t - DELAY] + load[t]
    pv += 0.2 * random.standard_normal(n)
    for signal in (mv, pv):
        start = random.integers(10, n - 10)
        signal[start : start + random.integers(0, 5)] = np.nan
    return mv - np.nanmean(mv), pv - np.nanmean(pv)


@settings(max_examples=12, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    structure=st.sampled_from([INTEGRATOR, FIRST_ORDER, SECOND_ORDER]),
    noise_order=st.integers(0, 2),
    walk=st.sampled_from([0.0, 0.01, 0.3]),
)
def test_the_filter_over_columns_is_generalised_least_squares(seed, structure, noise_order, walk):
    mv, pv = loop(seed)
    fast = fit_armax(mv, pv, DELAY, structure, noise_order, walk)
    weights, eta, variance, aic = armax(mv, pv, DELAY, structure, noise_order, walk)
    process = fast.process
    fitted = {
        INTEGRATOR: [process.b1],
        FIRST_ORDER: [process.a1, process.b1],
        SECOND_ORDER: [process.a1, process.a2, process.b1, process.b2],
    }[structure]
    np.testing.assert_allclose([*fitted, *[fast.c1, fast.c2][:noise_order]], weights, rtol=1e-6, atol=1e-8)
    np.testing.assert_allclose(fast.eta, eta, rtol=1e-6, atol=1e-8)
    np.testing.assert_allclose([fast.variance, fast.aic], [variance, aic], rtol=1e-6)
