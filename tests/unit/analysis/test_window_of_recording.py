"""A recording becomes a window: on a uniform grid, without impossible values, whoever makes it."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from agent.analysis.record.recording import LARGEST, LoopHints, LoopWindow
from agent.analysis.record.window_of_recording import loop_window
from agent.runtime.intake.window import RollingWindow
from connectors.recording import RecordedLoop
from tests.unit.runtime.loops import loop_settings, push_all, sample

LOST = [1e30, -1e30, np.inf, -np.inf, 1e300, LARGEST]
"""What historians and broken links write for a value that is missing."""


def recorded(**columns):
    n = 12
    known = {"op": np.arange(n) + 40.0, "pv": np.arange(n) + 20.0, "sp": np.full(n, 21.0), "mv": None}
    return RecordedLoop(
        "FIC101", Path("FIC101.csv"), 5.0 + 2.0 * np.arange(n), mode=None, duplicates=1, **(known | columns)
    )


def test_rows_go_onto_a_grid_with_all_that_is_known():
    modes = ("AUTO",) * 10 + ("MAN", "")
    hints = LoopHints(order=2)
    window = loop_window(replace(recorded(), mode=modes), hints)
    assert (window.loop, window.start, window.ts, len(window)) == ("FIC101", 5.0, 2.0, 12)
    assert (window.duplicates, window.hints, window.mv) == (1, hints, None)
    assert window.automatic.tolist() == [True] * 10 + [False, True]
    assert window.pv[[*range(10), 11]].tolist() == [20.0 + k for k in (*range(10), 11)]
    assert np.isnan(window.pv[10])


def test_times_that_run_backward_are_refused_with_their_place():
    loop = recorded()
    loop.time[7] = 0.0
    with pytest.raises(ValueError, match="time runs backward at index 7"):
        loop_window(loop)


@pytest.mark.parametrize("value", LOST)
@pytest.mark.parametrize("column", ["op", "pv", "sp", "mv"])
def test_an_impossible_value_of_a_recording_is_a_gap(column, value):
    values = np.arange(12.0)
    values[4] = value
    window = loop_window(recorded(**{column: values}))
    assert np.flatnonzero(np.isnan(getattr(window, column))).tolist() == [4]
    assert values[4] == value  # the recording stays as it is


@pytest.mark.parametrize("value", LOST)
def test_an_impossible_value_from_a_bus_is_a_gap(value):
    rolling = RollingWindow(loop_settings(seconds=20.0))
    samples = [
        sample(role, float(k), value if (role, k) == ("pv", 6) else k + 1.0)
        for k in range(22)
        for role in ("pv", "op")
    ]
    (window,) = push_all(rolling, samples)
    assert np.isnan(window.pv[6])
    assert np.isfinite(window.op).all()


def test_no_window_can_hold_an_impossible_value():
    window = LoopWindow("FIC101", 0.0, 1.0, op=np.array(LOST), pv=np.array([-9e14, 9e14, 0.0, 1.0, 2.0, 3.0]))
    assert not window.valid.any()
    again = replace(window, mv=np.array(LOST))
    assert np.isnan(again.mv).all()
    assert np.array_equal(again.pv, window.pv)
