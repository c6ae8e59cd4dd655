"""A recorded limit cycle of a valve that sticks: the workbench names its hysteresis, as the label does."""

from agent.analysis.record.window_of_recording import loop_window
from agent.workbench.session import Workbench
from connectors.recording import read_recording

VALVE = "valve_hysteresis"


def test_the_hysteresis_of_a_limit_cycle_is_named(recordings):
    """``CHEM10``: a first fit with the dead time that stands for the valve lost it (decision 111)."""
    bench = Workbench(loop_window(read_recording(recordings / "isdb" / "CHEM10.csv")))
    decision = bench.candidates()
    assert decision.family == VALVE
    assert decision.kind in {"confirmed", "family"}
    largest = max(decision.candidates, key=lambda each: each.error_reduction_percent)
    assert largest.family == VALVE
    assert largest.error_reduction_percent > 80
