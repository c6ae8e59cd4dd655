import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from agent.analysis.record.grid import uniform_grid

UTC = 1.7e9


def test_missing_rows_become_nan_and_nothing_else_does():
    grid = uniform_grid([0.0, 1.0, 4.0, 5.0], {"op": [1.0, 2.0, 3.0, 4.0]})
    np.testing.assert_array_equal(grid.columns["op"], [1.0, 2.0, np.nan, np.nan, 3.0, 4.0])
    assert (grid.start, grid.ts, grid.duplicates) == (0.0, 1.0, 0)


def test_of_duplicates_the_first_is_kept_and_the_rest_are_counted():
    grid = uniform_grid([0.0, 1.0, 1.0, 1.0, 2.0], {"op": [1.0, 2.0, 7.0, 8.0, 3.0]})
    np.testing.assert_array_equal(grid.columns["op"], [1.0, 2.0, 3.0])
    assert grid.duplicates == 2


def test_backward_time_names_the_row():
    with pytest.raises(ValueError, match="backward at index 3"):
        uniform_grid([0.0, 1.0, 2.0, 1.5], {"op": [0.0] * 4})


@pytest.mark.parametrize(
    ("time", "ts", "message"),
    [
        ([], None, "no rows"),
        ([0.0, np.nan], None, "index 1"),
        ([0.0, 1.0], 0.0, "positive"),
        ([0.0, 1.0, UTC], None, "more than 10000000 samples"),
    ],
)
def test_times_that_make_no_grid_are_refused(time, ts, message):
    with pytest.raises(ValueError, match=message):
        uniform_grid(time, {"op": np.zeros(len(time))}, ts)


def test_one_row_is_a_grid_of_one_point():
    grid = uniform_grid([UTC], {"op": [3.0]})
    np.testing.assert_array_equal(grid.columns["op"], [3.0])


@given(
    st.lists(st.floats(-0.4, 0.4), min_size=2, max_size=200),
    st.sampled_from([0.1, 1 / 3, 1.0, 12.0]),
)
def test_jitter_below_half_a_step_moves_no_row(jitter, ts):
    jitter[0] = 0.0
    time = UTC + ts * (np.arange(len(jitter)) + np.array(jitter))
    grid = uniform_grid(time, {"op": np.arange(len(jitter))}, ts)
    np.testing.assert_array_equal(grid.columns["op"], np.arange(len(jitter)))


def test_a_step_that_the_clock_rounds_does_not_drift_over_a_long_record():
    n = 20_000
    time = np.round(UTC + np.arange(n) / 3, 3)  # milliseconds: steps of 0.333 and 0.334 s
    grid = uniform_grid(time, {"op": np.arange(n)})
    np.testing.assert_array_equal(grid.columns["op"], np.arange(n))
    assert grid.ts == pytest.approx(1 / 3, rel=1e-6)
