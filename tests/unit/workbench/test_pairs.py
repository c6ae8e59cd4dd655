"""An event is compared with the likeliest two effects that act on OP, by the likelihood of all hypotheses."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from loops import GAIN, LEVEL, made

from agent.analysis.record.recording import LoopWindow
from agent.physics.bases import Fopdt
from agent.physics.effects import EFFECTS
from agent.physics.loop_model import LoopModel
from agent.workbench.checks import doubts, pairs
from agent.workbench.checks.doubts import STANDS_FOR_OP
from agent.workbench.checks.pairs import Pair, as_likely_words, far_likelier_words, is_beside, likeliest_pair
from agent.workbench.evidence import Evidence, evidence_of
from agent.workbench.hooks import silent
from agent.workbench.record import bare_record
from agent.workbench.residual.very_strong import VERY_STRONG
from agent.workbench.session.opening import opened
from agent.workbench.step import step_of

NAMED = {each.name: each for each in EFFECTS}


def evidence(criterion, family="valve", *, answers=True, once=False, odds=20.0):
    return Evidence(1e-6, criterion, odds, family, answers, once)


def pair_of(monkeypatch, found, beside):
    """The likeliest pair of ``found``, where ``beside`` is found on top of the first of them."""
    monkeypatch.setattr(pairs, "evidence_of", lambda smaller, larger, *_: beside[smaller, larger])
    models = {name: name for name in found}

    def also(model):
        return [SimpleNamespace(name=other) for first, other in beside if first == model]

    return likeliest_pair(found, models, also, lambda _, other: other.name, None, len(found))


def test_a_pair_is_the_likeliest_that_acts_on_op_and_the_likeliest_beside_it(monkeypatch):
    found = {
        "step": evidence(180.0, "load", answers=False, once=True),
        "gain": evidence(170.0, "gain", once=True),
        "answer": evidence(150.0, odds=-1.0),
        "slack": evidence(90.0),
        "rate": evidence(60.0, "speed"),
    }
    beside = {
        ("slack", "rate"): evidence(100.0, "speed"),
        ("slack", "trim"): evidence(40.0, "trim"),
        ("slack", "idle"): evidence(200.0, "lag", odds=-1.0),
    }
    assert pair_of(monkeypatch, found, beside) == Pair(("slack", "rate"), 190.0, "rate")


def test_an_effect_beside_which_none_gains_is_compared_alone(monkeypatch):
    step = evidence(180.0, "load", answers=False, once=True)
    assert pair_of(monkeypatch, {"step": step}, {}) is None
    assert pair_of(monkeypatch, {"step": step, "slack": evidence(90.0)}, {}) == Pair(
        ("slack",), 90.0, "slack"
    )


def test_what_is_compared_is_named_in_words():
    assert "with rate limit and slack together the" in far_likelier_words(
        Pair(("rate_limit", "slack"), 1.0, None)
    )
    assert as_likely_words(Pair(("slack",), 1.0, None)) == "with slack the record is as likely"


@pytest.fixture(scope="module")
def stepped():
    """A loop with one step of its load: what was opened, the base, and how much likelier a load step is."""
    window = made(noise=0.05)
    pv = window.pv + 1.5 * (np.arange(len(window)) > 430)
    trials, alone = opened(replace(window, pv=pv), Fopdt(), map, silent)
    base = step_of(alone, trials.record, None)
    found = trials.judged_on(base, [NAMED["load_step"]])
    return trials, base, evidence_of(base, found.models["load_step"], trials.record, 1).criterion


@pytest.mark.parametrize(
    ("more", "beside", "verdict"),
    [
        (-1.5 * VERY_STRONG, False, ("confirmed", "load_step")),
        (0.5 * VERY_STRONG, False, ("suggested", "load_step")),
        (0.5 * VERY_STRONG, True, ("confirmed", "load_step")),
        (1.5 * VERY_STRONG, True, ("suggested", "rate_limit")),
    ],
    ids=["far less likely", "as likely", "as likely, of another part", "far likelier"],
)
def test_an_event_stands_by_how_likely_the_record_is_with_two_effects(
    monkeypatch, stepped, more, beside, verdict
):
    trials, base, criterion = stepped
    pair = Pair(("rate_limit", "saturation"), criterion + more, None)
    monkeypatch.setattr(doubts, "likeliest_pair", lambda *_: pair)
    monkeypatch.setattr(doubts, "is_beside", lambda *_: beside)
    decision = trials.judged_on(base, [NAMED["rate_limit"], NAMED["load_step"]]).decision
    assert (decision.kind, decision.effect) == verdict
    assert (as_likely_words(pair) in decision.lacks) == (verdict == ("suggested", "load_step"))
    assert (far_likelier_words(pair) in decision.lacks) == (verdict == ("suggested", "rate_limit"))


@pytest.mark.parametrize("height", [0.6, 0.0], ids=["a step", "no step"])
def test_an_event_and_a_lag_need_each_other_where_both_are_there(height):
    window = made((NAMED["second_order"],), (4.0,))
    pv = window.pv + height * (np.arange(len(window)) > 430)
    trials, alone = opened(replace(window, pv=pv), Fopdt(), map, silent)
    base = step_of(alone, trials.record, None)
    together = trials.begun.together
    lag, step = (together(base, NAMED[name]) for name in ("second_order", "load_step"))
    assert is_beside(Pair(("second_order",), 1.0, lag), step, together, trials.record) == (height > 0)


@pytest.fixture(scope="module")
def moved_twice():
    """A loop with a dead band and a limited speed, OP moved up and back: what was opened, and the base."""
    op = np.repeat(np.array([50.0, 50.0, 56.0, 56.0, 56.0, 50.0, 50.0, 50.0]), 80)
    model = LoopModel(Fopdt(), (NAMED["rate_limit"], NAMED["deadband"]))
    facts = bare_record(LoopWindow("loop", 0.0, 1.0, op, op)).facts
    known = {"delay": 4.0, "tau": 9.0, "rate_limit.rate": 0.3, "deadband.s": 2.0, "deadband.damping": 0.1}
    values = np.array([known.get(name, 0.0) for name, _ in model.parameters(facts)])
    noise = 0.15 * np.random.default_rng(1).standard_normal(len(op))
    pv = LEVEL + GAIN * model.columns(op, values, facts)[:, 0] + noise
    trials, alone = opened(LoopWindow("loop", 0.0, 1.0, op, pv), Fopdt(), map, silent)
    return trials, step_of(alone, trials.record, None)


def test_two_effects_of_which_neither_stands_alone_are_suggested_in_place_of_an_event(moved_twice):
    trials, base = moved_twice
    able = [NAMED[each] for each in ("deadband", "rate_limit", "load_step")]
    decision = trials.judged_on(base, able).decision
    assert (decision.kind, decision.effect, decision.rivals) == ("suggested", "rate_limit", ("deadband",))
    assert "rate limit and deadband together" in decision.lacks[0]
    event = next(each for each in decision.candidates if each.effect == "load_step")
    assert "far more likely" in event.objection


def test_without_the_second_effect_nothing_stands_for_both(moved_twice):
    """The speed alone is too little, and the steps begin where PV answers moves of OP."""
    trials, base = moved_twice
    decision = trials.judged_on(base, [NAMED[each] for each in ("rate_limit", "load_step")]).decision
    assert decision.kind == "none"
    event = next(each for each in decision.candidates if each.effect == "load_step")
    assert event.objection == STANDS_FOR_OP
