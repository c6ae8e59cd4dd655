"""A gain that changes is told from a load that steps, which moves the level as much."""

import numpy as np
import pytest
from test_closed_loop import N, answered_more, free_run, loop

from agent.analysis.recording import LoopWindow
from agent.physics.bases import Fopdt
from agent.physics.effects.gain_change import GainChange
from agent.physics.loop_model import LoopModel
from agent.workbench.event_scan import instants_seen
from agent.workbench.fit import fit, nested_fit
from agent.workbench.likeliest import VERY_STRONG
from agent.workbench.other_level import beside_other_level
from agent.workbench.prediction_search import predictor
from agent.workbench.record import bare_record

LATER = np.arange(N) > 1000


def beside(op, pv):
    record = bare_record(LoopWindow("loop", 0.0, 1.0, op, pv))
    base = fit(LoopModel(Fopdt()), record, record.weight)
    larger = nested_fit(base, LoopModel(Fopdt(), (GainChange(),)), record)
    smaller = predictor(base, record)
    return beside_other_level(*predictor(larger, record, smaller, instants_seen(*smaller, GainChange())))


@pytest.mark.parametrize("seed", [0, 1])
def test_a_load_that_steps_is_no_other_gain(seed):
    op, pv = loop(seed, slack=0.0)
    assert beside(op, pv + free_run(np.where(LATER, 5.0, 0.0), 0.0)) < VERY_STRONG


@pytest.mark.parametrize("seed", [0, 1])
def test_another_gain_is_more_than_another_level(seed):
    op, pv = loop(seed, slack=0.0)
    assert beside(op, pv + answered_more(op, LATER)) > 3 * VERY_STRONG
