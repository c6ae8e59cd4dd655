import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from agent.analysis.quantify.processes.output_error import (
    FIRST_ORDER,
    INTEGRATOR,
    SECOND_ORDER,
    output_errors,
)
from agent.analysis.quantify.valves.valve_law import CHOUDHURY, HE, KANO
from tests.reference.lee2008_by_hand import output_error

DELAYS = np.array([1, 2, 5])


def loop(seed, order):
    """OP wanders; a valve between OP and PV sticks somewhat; PV is noisy; both have gaps."""
    random = np.random.default_rng(seed)
    n = 160
    op = 5 * np.sin(np.arange(n) / 8) + 0.3 * np.cumsum(random.standard_normal(n))
    pole = random.uniform(0.5, 0.95)
    pv = op
    for _ in range(order):
        pv = np.convolve(pv, pole ** np.arange(80))[:n] * (1 - pole)
    pv = np.roll(pv, 2) + 0.1 * random.standard_normal(n)
    for signal, start in ((op, random.integers(20, n - 30)), (pv, random.integers(0, n - 30))):
        signal[start : start + random.integers(0, 8)] = np.nan
    return op, pv - np.nanmean(pv)


@settings(max_examples=40, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    structure=st.sampled_from([INTEGRATOR, FIRST_ORDER, SECOND_ORDER]),
    gain_sign=st.sampled_from([-1, 0, 1]),
    law=st.sampled_from([HE, CHOUDHURY, KANO]),
)
def test_the_compiled_objective_is_the_one_written_by_hand(seed, structure, gain_sign, law):
    op, pv = loop(seed, max(1, structure))
    bands = np.array([[0.0, 0.0], [0.5, 0.5], [2.0, 0.4], [4.0, 0.0], [100.0, 1.0]])
    fast = output_errors(op, pv, bands, DELAYS, structure, gain_sign, law)
    slow = [
        [output_error(op, pv, *band, delay, structure, gain_sign, law) for delay in DELAYS] for band in bands
    ]
    np.testing.assert_allclose(fast, slow, rtol=1e-6)
    assert np.isinf(fast[-1]).all(), "a valve that never moves explains nothing"


@pytest.mark.parametrize("structure", [INTEGRATOR, FIRST_ORDER, SECOND_ORDER])
def test_the_comparison_above_sees_plausible_models(structure):
    finite = [
        np.isfinite(
            output_errors(*loop(seed, max(1, structure)), np.zeros((1, 2)), DELAYS, structure, 0, HE)
        ).any()
        for seed in range(20)
    ]
    assert np.mean(finite) > 0.5
