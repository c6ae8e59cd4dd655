import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from agent.analysis.quantify import mode_sequence as compiled
from agent.physics.processes.arx import Arx
from tests.reference.mode_sequence_by_hand import mode_sequence


@settings(max_examples=20, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    delay=st.integers(1, 6),
    price=st.floats(0, 20),
    gap=st.integers(0, 110),
    order=st.sampled_from([1, 2]),
)
def test_the_compiled_bank_is_the_one_of_objects(seed, delay, price, gap, order):
    random = np.random.default_rng(seed)
    op = 5 * np.sin(np.arange(120) / 9) + 0.3 * random.standard_normal(120)
    pv = 3 * np.sin(np.arange(120) / 9 - 1) + 0.3 * random.standard_normal(120)
    (op if seed % 2 else pv)[gap : gap + 8] = np.nan
    a2, b2 = (0.0, 0.0) if order == 1 else (-0.1, 0.05)
    process = Arx(0.9, a2, 0.1, b2, 0.02, delay)
    fast = compiled.mode_sequence(op, pv, process, 0.1, price)
    np.testing.assert_allclose(fast, mode_sequence(op, pv, process, 0.1, price), rtol=1e-12)


def test_without_a_start_there_is_no_sequence():
    op, pv = np.ones(60), np.full(60, np.nan)
    assert np.isnan(compiled.mode_sequence(op, pv, Arx(0.9, 0.0, 0.1, 0.0, 0.0, 2), 1.0, 8.0)).all()
