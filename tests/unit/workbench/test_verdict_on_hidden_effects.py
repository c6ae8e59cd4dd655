"""From a record to the verdict: what a scenario hides is added, and never what it does not hide.

The records are those of the scenarios for training (`config/scenarios/workbench`), simulated by physics that
the workbench does not fit; `truth.yaml` lists what each hides.
"""

import pytest

from agent.analysis.record.recording import LoopWindow
from agent.physics.effects import EFFECTS
from agent.workbench.session import Workbench
from simulators.hidden_faults import FOLDER, hidden_faults
from simulators.plant import simulate
from simulators.scenario import load_scenario

FAMILY = {
    "stiction": "valve_hysteresis",
    "slack": "valve_hysteresis",
    "rate_limit": "valve_speed",
    "stops": "valve_limits",
    "trim": "valve_characteristic",
    "slow_positioner": "extra_lag",
    "slow_transmitter": "extra_lag",
    "second_lag": "extra_lag",
    "inverse_response": "process_dynamics",
    "integrating": "process_dynamics",
    "load_wave": "disturbance",
    "load_steps": "disturbance",
    "gain_changes": "gain",
}
"""Fault of a scenario -> family of the effects that describe it."""
FAMILIES = {each.name: each.family for each in EFFECTS}
LEFT_OPEN = {"wb102", "wb105", "wb106", "wb112"}
"""Records on which what is hidden is not confirmed: OP stands at the stop, or too little shows."""
STEM_SEEN = {"wb110"}
"""Records that show that the stem needs time as well (0.4 s, of the valve's own damping): a lag of less than
a sample is added, which is true and in no list of faults."""
NAMES = [path.stem for path in sorted((FOLDER / "workbench").glob("*.yaml"))]


@pytest.mark.bench  # half a minute to two of CPU each
@pytest.mark.timeout(1200)  # of a core that other work may use
@pytest.mark.parametrize("name", NAMES)
def test_what_is_hidden_is_added_and_nothing_else(name):
    scenario = load_scenario(FOLDER / "workbench" / f"{name}.yaml")
    record = simulate(scenario)
    window = LoopWindow(scenario.loop, 0.0, scenario.ts, record.op, record.pv, record.sp)
    hidden = {FAMILY[fault] for fault in hidden_faults(scenario)}
    bench = Workbench(window)
    added = set()
    if bench.reason is None:
        bench.auto()
        added = {FAMILIES[each] for each in bench.comparison().steps[-1].effects}
    assert added <= hidden | ({"extra_lag"} if name in STEM_SEEN else set())
    if name not in LEFT_OPEN:
        assert hidden <= added
