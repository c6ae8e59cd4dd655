"""``--base auto`` on rigs that need more than a resonance, and a record that begins in motion."""

from __future__ import annotations

import pytest

from agent.analysis.record.recording import LoopWindow
from agent.workbench.session import Workbench
from benchmarks.rigs import in_halves
from simulators.balances.linear_rigs import linear_rig


@pytest.mark.bench  # the accuracy on one draw
def test_five_vessels_in_a_row_are_of_order_three_and_begin_in_motion() -> None:
    """The error of the best model of order three is 0.31, of the rig's noise 0.30."""
    rig = linear_rig(95000, "vessels")
    halves = in_halves("vessels", LoopWindow("vessels", 0.0, 1.0, rig.op, rig.pv))
    bench = Workbench(halves.fitted, base="auto", validate=halves.other)
    assert bench.base.name == "third_order"
    assert bench.step.rmse_validation is not None
    assert bench.step.rmse_validation < 0.32
