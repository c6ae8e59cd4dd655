import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from agent.analysis.stiction.shapes.nearest_neighbours import prediction_error
from tests.reference import nearest_neighbours_by_hand


@settings(max_examples=25, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    samples=st.integers(60, 120),
    cycle=st.integers(3, 9),
    neighbours=st.integers(1, 8),
    walk=st.booleans(),
)
def test_the_compiled_prediction_is_the_one_written_by_hand(seed, samples, cycle, neighbours, walk):
    noise = np.random.default_rng(seed).normal(size=samples)
    x = np.cumsum(noise) if walk else noise
    by_hand = nearest_neighbours_by_hand.prediction_error(x, cycle, neighbours)
    assert prediction_error(x, cycle, neighbours) == pytest.approx(by_hand, rel=1e-9)


def test_what_is_too_short_has_no_prediction():
    with pytest.raises(ValueError, match="too few"):
        prediction_error(np.zeros(40), 7, 8)
