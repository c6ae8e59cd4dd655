"""Instants that know nothing of OP lie anywhere; what stands for another lies where moves of OP arrive."""

import numpy as np
import pytest
from test_closed_loop import N, loop

from agent.analysis.record.recording import LoopWindow
from agent.physics.bases import Fopdt
from agent.physics.effects.load_step import STEPS, LoadStepEffect
from agent.physics.loop_model import LoopModel
from agent.workbench.coincidence import LEVEL, coincidence_p
from agent.workbench.fit import fit
from agent.workbench.prediction_search import predictor
from agent.workbench.record import bare_record

MOVES = 100 * np.arange(2, N // 100 - 1)
"""When the set point steps, samples; OP moves at once, and PV a sample later."""


@pytest.fixture(scope="module")
def p_of():
    """How likely by chance a load would step at these instants, samples."""
    record = bare_record(LoopWindow("loop", 0.0, 1.0, *loop(0, slack=0.0)))
    predicts, best = predictor(fit(LoopModel(Fopdt(), (LoadStepEffect(),)), record, record.weight), record)
    values = predicts.space.values(best)

    def asked(instants):
        return coincidence_p(predicts, predicts.space.at(np.array([*values[:-4], *instants, values[-1]])))

    return asked


def test_of_instants_drawn_at_random_p_is_one_of_chance(p_of):
    rng = np.random.default_rng(0)
    found = np.array([p_of(rng.uniform(0.05 * N, 0.95 * N, STEPS)) for _ in range(200)])
    assert np.mean(found < 5 * LEVEL) <= 0.1
    assert 0.35 < np.median(found) < 0.65


@pytest.mark.parametrize("late", [1.0, 2.0])
def test_instants_at_which_moves_arrive_know_of_op(p_of, late):
    rng = np.random.default_rng(1)
    assert all(p_of(rng.choice(MOVES, STEPS, replace=False) + late) < LEVEL for _ in range(20))


def test_what_op_does_afterwards_is_no_coincidence(p_of):
    """It may be the controller's answer."""
    rng = np.random.default_rng(2)
    found = [p_of(rng.choice(MOVES, STEPS, replace=False) - 3.0) for _ in range(20)]
    assert np.median(found) > 0.2
