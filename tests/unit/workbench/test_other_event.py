"""A gain that changes is told from a load that steps and from another answer at another level of OP."""

import numpy as np
import pytest
from test_closed_loop import N, answered_more, free_run, loop

from agent.analysis.record.recording import LoopWindow
from agent.physics.bases import Fopdt
from agent.physics.effects.gain_change import GainChange
from agent.physics.effects.load_step import LoadStepEffect
from agent.physics.loop_model import LoopModel
from agent.workbench.checks.other_event import begins_with_op, is_only_another_level
from agent.workbench.event_scan import instants_seen
from agent.workbench.first.first_fit import first_fit
from agent.workbench.fit import fit, nested_fit
from agent.workbench.objective import objective_of
from agent.workbench.prediction_search import predictor
from agent.workbench.predictor import predictor_behind
from agent.workbench.projection import target_of
from agent.workbench.record import bare_record
from agent.workbench.residual.holm import LEVEL
from agent.workbench.trial import beside

LATER = np.arange(N) > 1000


def told(effect, op, pv):
    """The model with an effect, where it predicts best."""
    record = bare_record(LoopWindow("loop", 0.0, 1.0, op, pv))
    base = fit(LoopModel(Fopdt()), record, record.weight)
    larger = nested_fit(base.values, LoopModel(Fopdt(), (effect,)), record)
    smaller = predictor(base, record)
    seen = beside(smaller[0].space.values(smaller[1]), instants_seen(*smaller, effect))
    return predictor(larger, record, first_fit(*smaller, effect, seen), seen)


def open_loop(levels):
    """OP at these levels, as long each, and PV of a slow load."""
    rng = np.random.default_rng(0)
    op = np.repeat(np.array(levels, dtype=float), N // len(levels)) + 0.2 * rng.standard_normal(N)
    load = np.zeros(N)
    for t in range(1, N):
        load[t] = 0.97 * load[t - 1] + 0.02 * rng.standard_normal()
    return op, free_run(op, 0.0) + load + 0.01 * rng.standard_normal(N)


def stepped_pv(pv, *heights):
    """PV with loads behind a lag of ten samples, (sample, height)."""
    return pv + sum(free_run(np.where(np.arange(N) > at, height, 0.0), 0.0) for at, height in heights)


@pytest.mark.parametrize("seed", [0, 1])
def test_a_load_that_steps_is_no_other_gain(seed):
    op, pv = loop(seed, slack=0.0)
    assert is_only_another_level(*told(GainChange(), op, stepped_pv(pv, (1000, 5.0))))


@pytest.mark.parametrize("seed", [0, 1])
def test_another_gain_is_more_than_another_level(seed):
    op, pv = loop(seed, slack=0.0)
    assert not is_only_another_level(*told(GainChange(), op, pv + answered_more(op, LATER)))


def test_another_answer_from_a_level_on_that_op_comes_to_once_is_no_other_gain():
    op, pv = open_loop((-3, -5, -2, -4, -1, 2, 5, 1, 4, 3))
    assert is_only_another_level(*told(GainChange(), op, pv + answered_more(op, op > 0.5)))


def test_another_gain_is_reported_where_op_moves_at_the_same_levels_before_and_after():
    op, pv = open_loop((-3, 5, -2, 4, -1, 2, -5, 1, -4, 3))
    assert not is_only_another_level(*told(GainChange(), op, pv + answered_more(op, LATER)))


BUMP = np.where((np.arange(N) > 300) & (np.arange(N) <= 500), -5.0, 0.0)
RAMP = np.linspace(0.0, 5.0, N)


@pytest.mark.parametrize(
    ("op", "instants", "stand"),
    [(BUMP, (301.0, 501.0), True), (BUMP, (280.0, 1400.0), False), (RAMP, (301.0, 501.0), False)],
    ids=["at its moves", "before one and elsewhere", "OP goes slowly all the time"],
)
def test_steps_at_moves_of_op_stand_for_the_answer_to_them(op, instants, stand):
    """A load from outside knows nothing of OP; what begins before OP moves is no answer to it."""
    pv = free_run(op, 0.0) + 0.02 * np.random.default_rng(1).standard_normal(N)
    record = bare_record(LoopWindow("loop", 0.0, 1.0, op, pv))
    model = LoopModel(Fopdt(), (LoadStepEffect(steps=2),))
    objective = objective_of(model, record, target_of(record, record.weight, linear=True))
    predicts = predictor_behind(objective, free_run(op, 0.0))
    named = {"delay": 1.0, "tau": 9.5, "load_step.tau": 9.5}
    named |= dict(zip(("load_step.time", "load_step.time_2"), instants, strict=True))
    at = objective.space.at(np.array([named[each] for each in objective.space.names]))
    assert (begins_with_op(predicts, at) < LEVEL) == stand
