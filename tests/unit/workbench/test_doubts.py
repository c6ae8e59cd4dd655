"""What speaks against an effect: what it leaves of the failure, unless that is another's."""

from types import SimpleNamespace

import numpy as np
import pytest

from agent.workbench import doubts
from agent.workbench.decision import Decision
from agent.workbench.doubts import Doubts
from agent.workbench.evidence import Evidence
from agent.workbench.residual.state_dependence import Dependence

FAILS = {"op_rate": Dependence(1e-9, 1.0)}
RESOLVED = {"op_rate": Dependence(0.5, 0.0)}


@pytest.fixture
def asked(monkeypatch):
    """Doubts of a load step that leaves what the rate of OP tells, beside another effect."""
    monkeypatch.setattr(doubts, "state_dependence", lambda left: left)

    def made(
        other,
        *,
        other_leaves=RESOLVED,
        step_leaves=True,
        both=True,
        arrives_by_chance=0.5,
        gain=False,
        null=0.01,
    ):
        monkeypatch.setattr(doubts, "coincidence_p", lambda _: arrives_by_chance)
        monkeypatch.setattr(doubts, "is_another_gain", lambda _: gain)
        left = {
            "load_step": FAILS if step_leaves else RESOLVED,
            "other": other_leaves,
        }
        found = {"load_step": Evidence(True, 0.0, 690.0, "load", answers=False, once=True), "other": other}
        models = {name: SimpleNamespace(predicts=(each,), fit=name) for name, each in left.items()}
        smaller = SimpleNamespace(estimate=SimpleNamespace(dependence=FAILS), predicts=None)
        decision = Decision("confirmed", "load_step", "load", (), (), ())
        return Doubts(smaller, models, found, lambda _: null, lambda *_: both).of(decision, {})

    return made


def lag(criterion=80.0, *, more=True, once=False, family="lag"):
    return Evidence(more, 0.0, criterion, family, answers=True, once=once)


def test_what_leaves_the_failure_stands_for_something_else(asked):
    assert asked(lag(2.0)) == {"load_step": 1.0}
    assert asked(lag(2.0), step_leaves=False) == {"load_step": 0.01}


def test_what_is_left_may_be_another_effect_that_is_missing_too(asked):
    assert asked(lag()) == {"load_step": 0.01}


@pytest.mark.parametrize(
    "other",
    [lag(11.0), lag(more=False), lag(once=True), lag(family="load")],
    ids=["weak", "tells no more", "happened once", "of its own family"],
)
def test_it_must_be_one_that_the_effect_does_not_stand_for(asked, other):
    assert asked(other) == {"load_step": 1.0}


def test_it_must_explain_what_is_left(asked):
    assert asked(lag(), other_leaves=FAILS) == {"load_step": 1.0}


def test_each_may_leave_what_the_other_explains(asked):
    assert asked(lag(), other_leaves={"op_level": Dependence(1e-9, 1.0)}) == {"load_step": 0.01}


def test_both_must_be_needed(asked):
    assert asked(lag(685.0)) == {"load_step": 0.01}
    assert asked(lag(685.0), both=False) == {"load_step": 1.0}


def test_a_load_that_steps_when_moves_of_op_arrive_is_something_else(asked):
    assert asked(lag(2.0), step_leaves=False, arrives_by_chance=0.02) == {"load_step": 0.01}
    assert asked(lag(685.0), step_leaves=False, arrives_by_chance=0.005) == {"load_step": 1.0}


def test_a_load_that_steps_and_does_what_another_gain_does_is_something_else(asked):
    assert asked(lag(685.0), step_leaves=False, gain=True) == {"load_step": 1.0}


@pytest.mark.parametrize("event", [{"gain": True}, {"arrives_by_chance": 0.005}])
def test_what_happened_outdoes_what_answers_op_whatever_kind_it_was_of(asked, event):
    assert asked(lag(600.0), step_leaves=False, **event) == {"load_step": 1.0, "other": 1.0}
    assert asked(lag(600.0), step_leaves=False, null=0.1, **event) == {"load_step": 1.0}
    assert asked(lag(600.0), step_leaves=False) == {"load_step": 0.01}


@pytest.mark.parametrize(("cycles", "height", "told"), [(5, 1.0, 1.0), (5, 20.0, 0.01), (30, 1.0, 0.01)])
def test_a_wave_of_few_cycles_must_be_most_of_what_is_left(monkeypatch, cycles, height, told):
    wave = height * np.sin(2 * np.pi * cycles * np.arange(1000) / 1000)
    noise = np.cumsum(np.random.default_rng(0).normal(size=1000))
    monkeypatch.setattr(doubts, "contributions", lambda *_: {"wave": wave})
    record = SimpleNamespace(op=np.zeros(1000), facts=SimpleNamespace(ts=1.0))
    predictor = SimpleNamespace(left=lambda at: at, objective=SimpleNamespace(record=record))
    smaller = SimpleNamespace(
        estimate=SimpleNamespace(dependence={}), predicts=(predictor, noise - noise.mean() + wave)
    )
    effect = SimpleNamespace(name="wave", parameters=lambda _: ("frequency",))
    fitted = SimpleNamespace(model=SimpleNamespace(effects=(effect,)))
    found = {"wave": Evidence(True, 0.0, 60.0, "disturbance", answers=False, once=False)}
    decision = Decision("confirmed", "wave", "disturbance", (), (), ())
    models = {"wave": SimpleNamespace(predicts=None, fit=fitted)}
    asked = Doubts(smaller, models, found, lambda _: 0.01, lambda *_: True)
    assert asked.of(decision, {}) == {"wave": told}


@pytest.fixture
def beside_a_wave(monkeypatch):
    """Doubts of a lag that leaves PV less a model as given, beside what leaves another, if anything."""
    monkeypatch.setattr(doubts, "state_dependence", lambda *_: RESOLVED)
    record = SimpleNamespace(op=np.zeros(1000), facts=SimpleNamespace(ts=1.0))

    def made(left, other=None):
        found, lefts = {"lag": lag()}, {"lag": left}
        if other is not None:
            lefts["wave"] = other
            found["wave"] = Evidence(True, 0.0, 60.0, "disturbance", answers=False, once=False)
        models = {
            name: SimpleNamespace(
                predicts=(
                    SimpleNamespace(left=lambda at: at, objective=SimpleNamespace(record=record)),
                    each,
                ),
                fit=name,
            )
            for name, each in lefts.items()
        }
        smaller = SimpleNamespace(estimate=SimpleNamespace(dependence=FAILS), predicts=None)
        decision = Decision("confirmed", "lag", "lag", (), (), ())
        return Doubts(smaller, models, found, lambda _: 0.01, lambda *_: True).of(decision, {})

    return made


def test_a_lag_that_leaves_a_wave_stands_for_it_where_no_candidate_is_that_wave(beside_a_wave):
    noise = np.random.default_rng(0).normal(size=1000)
    wave = noise + 5 * np.sin(np.arange(1000) / 8)
    assert beside_a_wave(noise) == {"lag": 0.01}
    assert beside_a_wave(wave) == {"lag": 1.0}
    assert beside_a_wave(wave, wave) == {"lag": 1.0}  # a decoy
    assert beside_a_wave(wave, noise) == {"lag": 0.01}
    assert beside_a_wave(noise + 0.5 * np.sin(np.arange(1000) / 8)) == {"lag": 0.01}


@pytest.mark.parametrize(("null", "told"), [(0.01, {"wave": 1.0, "valve": 0.01}), (0.2, {"valve": 0.2})])
def test_what_is_not_there_itself_outdoes_nothing(null, told):
    wave = Evidence(True, 0.0, 24.0, "disturbance", answers=False, once=False)
    valve = Evidence(True, 0.0, 51.0, "valve", answers=True, once=False)
    models = {name: SimpleNamespace(predicts=None, fit=name) for name in ("wave", "valve")}
    smaller = SimpleNamespace(estimate=SimpleNamespace(dependence={}), predicts=None)
    decision = Decision("suggested", "wave", "disturbance", ("valve",), ("valve",), ())
    asked = Doubts(smaller, models, {"wave": wave, "valve": valve}, lambda _: null, lambda *_: True)
    assert asked.of(decision, {}) == told
