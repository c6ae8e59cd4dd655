"""What the autoregression could do as well is told of no parameter: more in closed loop than in open."""

import numpy as np
import pytest
from test_closed_loop import free_run, loop

from agent.analysis.record.recording import LoopWindow
from agent.physics.bases import Fopdt
from agent.physics.loop_model import LoopModel
from agent.workbench.certainty.free_memory import with_free_memory
from agent.workbench.fit import fit
from agent.workbench.prediction_search import predictor
from agent.workbench.record import bare_record


def widened(op, pv):
    """How much wider the intervals of delay and lag are, (2,), and what is left of the least squares."""
    record = bare_record(LoopWindow("loop", 0.0, 1.0, op, pv))
    predicts, best = predictor(fit(LoopModel(Fopdt()), record, record.weight), record)
    freed = with_free_memory(predicts, best)
    return freed.spread(best) / predicts.spread(best), freed.error(best) / predicts.error(best)


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_intervals_widen_where_op_answers_to_the_load(seed):
    op, pv = loop(seed, slack=0.0)
    closed, left = widened(op, pv)
    assert np.all(closed > 1)
    assert 0.999 < left <= 1
    other_op, other_pv = loop(seed + 50, slack=0.0)
    opened, _ = widened(op, free_run(op, 0.0) + other_pv - free_run(other_op, 0.0))
    assert np.all(opened > 1)
    assert closed.sum() > opened.sum()
