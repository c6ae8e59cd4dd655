"""Compiled map against NumPy in the same run (issue 3): 1 % grid, ten delays, 1000 samples."""

import pytest

from benchmarks.lee2008_map import ORDERS, SEED, compiled_seconds, numpy_seconds, sticking_loop
from tests.reference.lee2008_numpy import map_by_candidate


@pytest.mark.bench
@pytest.mark.parametrize("structure", ORDERS)
def test_the_map_is_twenty_times_faster_than_numpy_valve_by_valve(structure):
    op, pv = sticking_loop(SEED, 1000)
    assert numpy_seconds(map_by_candidate, op, pv, structure) >= 20 * compiled_seconds(op, pv, structure)
