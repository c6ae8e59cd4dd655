"""The laboratory tanks, fitted on the estimation half alone: overflow is named, no fault of the pump."""

import numpy as np
import pytest

from agent.analysis.record.recording import LoopWindow
from agent.workbench.session import Workbench

NOT_TRIED = ("valve_hysteresis", "valve_characteristic", "valve_speed", "extra_lag", "disturbance", "gain")
NOT_TRIED += ("process_delay", "sensor_hysteresis")
"""To save time; docs/workbench/cascaded_tanks.md has the whole library."""


@pytest.mark.bench
@pytest.mark.timeout(900)  # a loaded machine takes its time
def test_overflow_is_confirmed_and_the_error_of_the_other_half_falls(recordings):
    rows = np.genfromtxt(recordings / "cascaded_tanks.csv", delimiter=",", skip_header=1, usecols=range(4))
    seen, other = (LoopWindow("tanks", 0.0, 4.0, rows[:, i], rows[:, i + 2]) for i in (0, 1))
    bench = Workbench(seen, "two_tanks", other, NOT_TRIED)
    assert [each.name for each in bench.library] == ["saturation", "overflow"]
    assert bench.step.rmse_validation == pytest.approx(0.58, abs=0.03)
    decision = bench.candidates()
    assert (decision.kind, decision.effect, decision.indistinguishable) == ("confirmed", "overflow", ())
    assert bench.add("overflow").rmse_validation < 0.25
