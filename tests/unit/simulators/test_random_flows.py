from typing import get_args

import numpy as np
import pytest

from simulators.draws.random_flows import DURATION, FlowKind, random_draw_of_flow, random_flow
from simulators.draws.random_moves import largest_rise
from simulators.plant import simulate


@pytest.mark.parametrize("kind", get_args(FlowKind))
def test_draw_keeps_the_promise_of_its_kind(kind):
    scenario = random_flow(1, kind)
    assert random_flow(1, kind) == scenario
    assert random_flow(2, kind) != scenario
    assert (scenario.truth.verdict == "stiction") == (kind == "flow_stiction")
    record = simulate(scenario)
    assert 0 < record.op.min() < record.op.max() < 100
    assert DURATION[0] <= len(record.op) <= DURATION[1]
    if kind == "flow_stiction":
        half = (scenario.valve.f_s + scenario.valve.f_d) / 2
        assert largest_rise(record.mv) > half
        assert largest_rise(-record.mv) > half


def test_loads_of_every_kind_are_drawn():
    rng = np.random.default_rng(0)
    scenarios = [random_draw_of_flow(rng, "x", seed, sticks=False) for seed in range(40)]
    assert any(each.drift.walk > 0 for each in scenarios)
    assert any(each.drift.ramp > 0 for each in scenarios)
    assert any(each.wander.std > 0 for each in scenarios)
    assert any(each.disturbance.amplitude > 0 for each in scenarios)
    assert any(each.load_steps for each in scenarios)
    assert any(not each.set_points for each in scenarios)
    assert np.median([each.process.tau for each in scenarios]) < 6
