"""Checks that lower a verdict: waves at OP's own cycle, worse validation; what a model still lacks."""

from types import SimpleNamespace

import numpy as np
from loops import slack

from agent.analysis.record.recording import LoopWindow
from agent.physics.effect import Parameter
from agent.physics.effects import EFFECTS
from agent.workbench import trials
from agent.workbench.checks.lacking import is_likeliest_by_far, lacks_words, larger_dynamics
from agent.workbench.checks.own_cycle import keeps_time_of_loop
from agent.workbench.checks.unnamed import AS_LIKELY
from agent.workbench.checks.wave_lines import NO_LINE
from agent.workbench.residual.very_strong import very_strong
from agent.workbench.session import Workbench
from agent.workbench.space import Space
from simulators.draws.open_records import open_record

T = np.arange(1500.0)
EVEN = 50 + 5 * np.sin(2 * np.pi * T / 50)
NOISE = 0.05 * np.random.default_rng(0).standard_normal(1500)


def test_a_wave_with_the_harmonics_of_friction_keeps_the_time_of_the_loop():
    friction = np.sign(np.sin(2 * np.pi * T / 50 + 0.4))
    assert keeps_time_of_loop(friction + NOISE, EVEN, 1 / 50, 1.0)
    assert keeps_time_of_loop(np.sin(6 * np.pi * T / 50) + NOISE, EVEN, 3 / 50, 1.0)


def test_a_pure_wave_or_one_of_another_time_is_a_load():
    assert not keeps_time_of_loop(np.sin(2 * np.pi * T / 50 + 0.4) + NOISE, EVEN, 1 / 50, 1.0)
    assert not keeps_time_of_loop(np.sin(2 * np.pi * T / 37) + NOISE, EVEN, 1 / 37, 1.0)
    wanders = np.cumsum(np.random.default_rng(1).standard_normal(1500)) * 0.05
    uneven = 50 + 5 * np.sin(2 * np.pi * T / 50 + wanders)
    assert not keeps_time_of_loop(np.sin(2 * np.pi * T / 50) + NOISE, uneven, 1 / 50, 1.0)


def test_slow_noise_that_goes_along_with_a_wave_is_none():
    record = open_record(91000, "steps", "coloured_noise")
    window = LoopWindow("loop", 0.0, record.scenario.ts, record.op, record.pv)
    decision = Workbench(window, without={each.name for each in EFFECTS} - {"sinusoid"}).candidates()
    assert (decision.kind, decision.candidates[0].objection) == ("none", NO_LINE)
    assert decision.candidates[0].p < 0.05


def evidence(family, criterion, **other):
    return SimpleNamespace(
        **(
            {
                "answers": True,
                "once": False,
                "family": family,
                "criterion": criterion,
                "plain": very_strong(criterion, 3),
            }
            | other
        )
    )


def test_which_effect_is_the_likeliest_by_far():
    found = {"trim": evidence("trim", 900.0), "stop": evidence("stop", 500.0), "wave": evidence("w", 895.0)}
    assert not is_likeliest_by_far("trim", found)
    del found["wave"]
    assert is_likeliest_by_far("trim", found)
    assert not is_likeliest_by_far("stop", found)
    found["trim"] = evidence("trim", 900.0, once=True)
    assert not is_likeliest_by_far("trim", found)
    assert not is_likeliest_by_far("trim", {"trim": evidence("trim", 9.0), "stop": evidence("stop", -9.0)})
    assert larger_dynamics({"second_order": None, "stiction": None}, {"second_order"}) == ()
    assert lacks_words({"op_rate"}) == "with it the model still fails with op rate"


def test_a_zero_where_nothing_is_less_is_no_bound():
    parameters = (
        Parameter("tau", "s", 0.0, 9.0),
        Parameter("rate", "OP/s", 0.5, 9.0),
        Parameter("c", "1", -1.0, 1.0),
    )
    low, high = (np.array([getattr(each, end) for each in parameters]) for end in ("low", "high"))
    space = Space(("tau", "rate", "c"), parameters, low, high, np.zeros(3, dtype=bool))
    assert space.at_bound(low) == ("rate", "c")
    assert space.at_bound(high) == ("tau", "rate", "c")


FEW = ["valve_limits", "valve_characteristic", "valve_speed", "extra_lag", "process_dynamics", "disturbance"]
FEW += ["gain", "stiction", "asymmetric_stiction"]


def test_what_makes_the_other_recording_worse_is_no_more_than_suggested(monkeypatch):
    bench = Workbench(slack(), without=FEW, validate=slack(seed=5))
    monkeypatch.setattr(trials, "rmse_on", lambda fitted, _: 1.0 + len(fitted.model.effects))
    decision = bench.candidates()
    assert (decision.kind, decision.effect) == ("suggested", "deadband")
    assert "less well" in decision.lacks[0]
    monkeypatch.undo()
    assert Workbench(slack(), without=FEW, validate=slack(seed=5)).candidates().kind == "confirmed"


def test_an_effect_must_beat_linear_dynamics_that_have_no_name():
    record = open_record(60002, "prbs", "second_order")
    window = LoopWindow("loop", 0.0, record.scenario.ts, record.op, record.pv)
    families = {each.family for each in EFFECTS} - {"valve_speed"}
    decision = Workbench(window, without=families).candidates()
    assert (decision.kind, decision.effect) == ("suggested", "rate_limit")
    assert AS_LIKELY in decision.lacks
    named = Workbench(window, without=families - {"extra_lag"}).candidates()
    assert (named.kind, named.family) == ("family", "extra_lag")


def test_a_rate_limit_that_is_there_beats_them():
    record = open_record(60003, "prbs", "rate_limit")
    window = LoopWindow("loop", 0.0, record.scenario.ts, record.op, record.pv)
    decision = Workbench(window, without={each.family for each in EFFECTS} - {"valve_speed"}).candidates()
    assert (decision.kind, decision.effect, decision.lacks) == ("confirmed", "rate_limit", ())
