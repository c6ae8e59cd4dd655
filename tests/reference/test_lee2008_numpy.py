import numpy as np
import pytest

from agent.analysis.quantify.processes.output_error import FIRST_ORDER, SECOND_ORDER, output_errors
from agent.analysis.quantify.valves.valve_law import HE
from tests.reference.lee2008_numpy import map_at_once, map_by_candidate

DELAYS = np.array([1, 3, 7])


@pytest.mark.parametrize("structure", [FIRST_ORDER, SECOND_ORDER])
@pytest.mark.parametrize("seed", range(3))
def test_the_compiled_map_is_that_of_numpy(seed, structure):
    random = np.random.default_rng(seed)
    op = 5 * np.sin(np.arange(300) / 9) + 0.2 * np.cumsum(random.standard_normal(300))
    pv = np.convolve(op, 0.8 ** np.arange(60))[:300] + 0.3 * random.standard_normal(300)
    pv -= pv.mean()
    # More valves than are taken together, those that never move among them.
    share = np.linspace(0, 1.2, 10) * np.ptp(op)
    bands = np.array([(f_s, f_d) for f_s in share for f_d in share if f_d <= f_s])
    compiled = output_errors(op, pv, bands, DELAYS, structure, 0, HE)
    assert 0 < np.isfinite(compiled).mean() < 1
    np.testing.assert_allclose(map_by_candidate(op, pv, bands, DELAYS, structure), compiled, rtol=1e-8)
    np.testing.assert_allclose(map_at_once(op, pv, bands, DELAYS, structure), compiled, rtol=1e-8)
