"""Loops of the hidden-effect benchmark, its short form; no threshold was set on seed 200."""

import pytest

from agent.analysis.record.recording import LoopWindow
from agent.physics.effects import EFFECTS
from agent.workbench.paired_blocks import LEAST_PERCENT
from agent.workbench.session import Workbench
from benchmarks.cases.decoy import Decoy
from benchmarks.cases.hidden_case import floor_of, judge
from simulators.draws.hidden_effects import hidden_effect_plant

pytestmark = pytest.mark.timeout(300)  # a loaded machine takes its time
NOT_TRIED = {each.family for each in EFFECTS} - {"valve_hysteresis", "valve_limits"}


@pytest.mark.bench
@pytest.mark.parametrize(("truth", "seed"), [("slow_drift", 6002), ("stiction", 6002)])
def test_a_valve_is_accused_where_it_sticks_and_not_where_op_answers_to_a_load(truth, seed):
    """Both loops look alike to the held-out error alone: docs/workbench/decision.md has the numbers."""
    plant = hidden_effect_plant(seed, truth)
    window = LoopWindow(plant.scenario.loop, 0.0, plant.scenario.ts, plant.op, plant.pv, plant.sp)
    bench = Workbench(window, without=NOT_TRIED)
    decision = bench.candidates()
    assert decision.candidates[0].family == "valve_hysteresis"
    assert decision.candidates[0].error_reduction_percent > LEAST_PERCENT
    assert decision.candidates[0].low > 0
    found = bench.auto()[-1]
    if truth == "stiction":
        assert decision.family == "valve_hysteresis"
        assert decision.kind in {"confirmed", "family"}
        assert found.held_out.rmse < 1.15 * floor_of(plant, bench.record)
    else:
        assert found.effects == ()


@pytest.mark.bench
@pytest.mark.parametrize(("truth", "seed"), [("none", 200), ("sinusoid", 200)])
def test_what_is_hidden_is_named_and_nothing_else(truth, seed):
    case = judge(truth, seed, test_without=False)
    assert not case.wrong
    assert not case.decoys
    assert case.family_right == (truth != "none")
    assert case.rmse_last < 1.15 * case.floor
    assert case.floor_low < case.floor < case.floor_high


def test_decoys_differ():
    assert Decoy(1).name != Decoy(2).name
    assert Decoy(1).family == "decoy"
