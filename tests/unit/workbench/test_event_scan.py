"""A load that wanders is no load that steps; one that steps, or another gain, is seen."""

import numpy as np
import pytest
from test_closed_loop import N, answered_more, free_run, loop

from agent.analysis.record.recording import LoopWindow
from agent.physics.bases import Fopdt
from agent.physics.effects.gain_change import GainChange
from agent.physics.effects.load_step import LoadStepEffect
from agent.physics.loop_model import LoopModel
from agent.workbench.event_scan import instant_p
from agent.workbench.fit import fit
from agent.workbench.prediction_search import predictor
from agent.workbench.record import bare_record


def predicted(op, pv):
    record = bare_record(LoopWindow("loop", 0.0, 1.0, op, pv))
    return predictor(fit(LoopModel(Fopdt()), record, record.weight), record)


@pytest.mark.parametrize("effect", [LoadStepEffect(), GainChange()])
def test_where_nothing_happened_p_is_one_of_chance(effect):
    found = [instant_p(*predicted(*loop(seed, slack=0.0)), effect) for seed in range(8)]
    assert all(0.0 < p <= 1.0 for p in found)
    assert min(found) > 2e-3
    assert 0.2 < np.median(found) < 0.9


def test_a_load_that_steps_and_goes_again_is_seen_and_rather_than_another_gain():
    op, pv = loop(2, slack=0.0)
    load = np.where((np.arange(N) > 700) & (np.arange(N) < 1100), 3.0, 0.0)
    asked = predicted(op, pv + free_run(load, 0.0))
    step, gain = (instant_p(*asked, effect) for effect in (LoadStepEffect(), GainChange()))
    assert step < 1e-6
    assert step < 0.1 * gain


def test_another_gain_is_seen():
    op, pv = loop(1, slack=0.0)
    asked = predicted(op, pv + answered_more(op, np.arange(N) > 1000))
    assert instant_p(*asked, GainChange()) < 1e-6


def test_the_answer_does_not_hang_on_units():
    op, pv = loop(3, slack=0.0)
    other = instant_p(*predicted(10 * op + 30, 0.01 * pv - 5), LoadStepEffect())
    assert other == pytest.approx(instant_p(*predicted(op, pv), LoadStepEffect()), rel=0.2)
