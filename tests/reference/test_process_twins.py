import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from agent.physics.processes import PROCESSES
from agent.physics.processes.decimation import block_means
from agent.physics.processes.process import DELAY
from tests.reference.process_superposition import superposition

SEEDS = st.integers(0, 2**32 - 1)
LAGS = st.one_of(st.floats(0.2, 300), st.sampled_from([1.0, 4.0]))  # equal ones must come up
DELAYS = st.one_of(st.floats(1, 60), st.integers(1, 60).map(float))


@pytest.mark.parametrize("process", PROCESSES, ids=lambda process: process.name)
@settings(deadline=None, max_examples=40)  # the first call compiles
@given(seed=SEEDS, lags=st.tuples(LAGS, LAGS), delay=DELAYS)
def test_the_kernel_is_the_sum_of_steps(process, seed, lags, delay):
    position = np.cumsum(np.random.default_rng(seed).standard_normal(50))
    lags = lags[: len(process.parameters) - 1]
    assert process.parameters[-1] is DELAY
    if len(lags) == 2 and 0 < abs(lags[0] - lags[1]) < 1e-4 * max(lags):
        lags = lags[0], lags[0]  # the twin divides by their difference
    expected = superposition(process.name, position, *lags, delay=delay)
    np.testing.assert_allclose(process.respond(position, (*lags, delay)), expected, rtol=0, atol=1e-8)


@settings(deadline=None)
@given(seed=SEEDS, n=st.integers(0, 60), factor=st.integers(1, 70), missing=st.floats(0, 0.3))
def test_block_means_are_the_means_of_blocks(seed, n, factor, missing):
    random = np.random.default_rng(seed)
    signal = np.where(random.random(n) < missing, np.nan, random.standard_normal(n))
    blocks = [signal[i : i + factor] for i in range(0, n - factor + 1, factor)]
    means = block_means(signal, factor)
    assert means.shape == (len(blocks),)
    for mean, block in zip(means, blocks, strict=True):
        assert mean == pytest.approx(math.fsum(block) / factor, abs=1e-12, nan_ok=True)
