"""Effects of hysteresis begin from the valve of the likeliest of them as well."""

from __future__ import annotations

import pytest

from agent.physics.effects import EFFECTS
from agent.workbench.first.valves_shared import likeliest_valve, to_seek
from agent.workbench.session import Workbench
from benchmarks.cases.hidden_case import drawn, floor_of

OTHERS = {each.family for each in EFFECTS} - {"valve_hysteresis"}


@pytest.mark.bench  # the accuracy on one draw
def test_the_simpler_effect_is_found_where_the_richer_one_was() -> None:
    """The search for `stiction` missed the valve, `asymmetric_stiction` had it with both jumps alike."""
    plant, window = drawn("stiction", 91175, "closed_loop")
    bench = Workbench(window, without=OTHERS)
    bench.auto()
    assert bench.step.effects == ("stiction",)
    found = {each.name: each for each in bench.step.parameters}
    for name in ("stiction.s", "stiction.j_over_s"):
        assert found[name].low <= plant.parameters[name][0] <= found[name].high
    tried = bench.trials.known(bench.staircase()[0])
    assert tried is not None
    likeliest = likeliest_valve(tried.models)
    assert likeliest in {"stiction", "asymmetric_stiction"}
    seeking = to_seek(tried.models, likeliest)
    assert set(seeking) == {"stiction", "asymmetric_stiction", "deadband"} - {likeliest}
    assert seeking["deadband"].valve.bands.s == pytest.approx(plant.parameters["stiction.s"][0], rel=0.1)


def test_without_hysteresis_there_is_no_valve_to_share() -> None:
    assert likeliest_valve({}) is None


@pytest.mark.bench  # the accuracy on one draw
def test_a_valve_that_moves_seldom_and_differs_by_direction_is_found() -> None:
    """OP moves 17 times; the engine's search, for valves alike in both directions, has none that is near."""
    plant, window = drawn("asymmetric_stiction", 91187, "steps")
    bench = Workbench(window, without=OTHERS)
    bench.auto()
    assert bench.step.effects == ("asymmetric_stiction",)
    assert bench.step.held_out.rmse < 1.15 * floor_of(plant, bench.record)
    found = {each.name.partition(".")[2]: each.value for each in bench.step.parameters}
    assert found["j_down"] > 2 * found["j_up"]
