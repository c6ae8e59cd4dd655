"""What is never confirmed is confirmed by no path: one effect, two at once, several recordings, any base."""

from dataclasses import replace

import numpy as np
import pytest
from loops import made, slack

from agent.analysis.record.recording import LoopWindow
from agent.physics.bases import Fopdt
from agent.physics.effects import EFFECTS
from agent.workbench import trials as tries
from agent.workbench.checks.own_cycle import WORDS as OWN_CYCLE
from agent.workbench.first.begun import Begun
from agent.workbench.hooks import silent
from agent.workbench.session import Workbench
from agent.workbench.session.opening import opened
from agent.workbench.several import together
from agent.workbench.several.together import compared_together
from agent.workbench.step import step_of
from simulators.draws.random_plants import random_plant
from simulators.plant import simulate

NAMED = {each.name: each for each in EFFECTS}
WAVES = {"sinusoid", "wave"}
VALVE = ("valve_hysteresis", "valve_speed", "valve_limits", "valve_characteristic", "sensor_hysteresis")


@pytest.fixture
def two(monkeypatch):
    """A base, two effects on it, and trials that would confirm both of them at once."""
    found, alone = opened(slack(), Fopdt(), map, silent)
    base = step_of(alone, found.record, None)
    tried = found.judged_on(base, [NAMED["deadband"], NAMED["sinusoid"]])
    monkeypatch.setattr(tries, "lowers_error", lambda *_: True)
    monkeypatch.setattr(tries, "far_likelier", lambda *_: True)
    monkeypatch.setattr(Begun, "together", lambda *_: tried.models["deadband"])
    return found, base, tried


def test_two_effects_are_not_confirmed_where_a_check_lowers_one(two):
    found, base, tried = two
    assert found.both(base, tried, "deadband", NAMED["sinusoid"]) is not None
    for name in ("sinusoid", "deadband"):
        lowered = replace(tried, lowered=frozenset({name}))
        assert found.both(base, lowered, "deadband", NAMED["sinusoid"]) is None


def test_two_effects_are_not_confirmed_where_validation_is_worse(monkeypatch, two):
    found, base, tried = two
    found = replace(found, validation=found.record)
    for each, taken in ((1.0, False), (-1.0, True)):
        monkeypatch.setattr(tries, "rmse_on", lambda fitted, _, by=each: by * len(fitted.model.effects))
        assert (found.both(base, tried, "deadband", NAMED["sinusoid"]) is not None) is taken


def test_the_model_that_is_taken_is_no_worse_on_the_other_recording(monkeypatch):
    """After the verdict a model gets another valve: what it was confirmed with stays."""
    bench = Workbench(slack(), without=[each.family for each in EFFECTS if each.name != "deadband"])
    bench.trials.validation = bench.record
    monkeypatch.setattr(
        tries.Trials, "with_valve_anew", lambda _, found: replace(found, fit=replace(found.fit, error=-1.0))
    )
    monkeypatch.setattr(tries, "rmse_on", lambda fitted, _: 2.0 if fitted.error < 0 else 1.0)
    assert bench.add("deadband").fit.error > 0


def test_a_wave_of_the_loop_is_no_more_than_suggested_by_several_recordings(monkeypatch):
    rest = [each.name for each in EFFECTS if each.name != "sinusoid"]
    windows = [made(seed=each) for each in (1, 2)]
    time = np.arange(len(windows[0]))
    waved = [replace(each, pv=each.pv + 2 * np.sin(2 * np.pi * time / 23)) for each in windows]
    benches = {str(i): Workbench(each, without=rest) for i, each in enumerate(waved)}
    assert compared_together(benches, (), auto=False).verdict.effect in WAVES
    monkeypatch.setattr(together, "may_be_loops_own", lambda *_: True)
    verdict = compared_together(benches, (), auto=False).verdict
    assert (verdict.kind, verdict.lacks) == ("suggested", (OWN_CYCLE,))


@pytest.mark.bench  # a minute or two of CPU
@pytest.mark.timeout(1200)
@pytest.mark.parametrize("base", ["fopdt", "auto"])
def test_what_friction_makes_is_no_wave_from_outside_though_friction_is_not_in_the_library(base):
    scenario = random_plant(3, "stiction")
    plant = simulate(scenario)
    half = len(plant.op) // 2
    first, second = (
        LoopWindow("loop", 0.0, scenario.ts, plant.op[part], plant.pv[part])
        for part in (slice(None, half), slice(half, None))
    )
    bench = Workbench(first, base, second, VALVE)
    bench.auto()
    assert not WAVES & set(bench.step.effects)
    took = [
        each for each in bench.staircase() if each.verdict and each.verdict.kind in {"confirmed", "family"}
    ]
    steps = bench.staircase()
    for each in took:
        assert each.rmse_validation <= steps[steps.index(each) - 1].rmse_validation
