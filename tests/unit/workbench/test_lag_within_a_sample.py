"""A lag that no sample shows moves a zero and a dead time; intervals hold where they may have been."""

import numpy as np
import pytest

from agent.analysis.record.recording import LoopWindow
from agent.physics.bases import BASES, Fopdt
from agent.physics.effects.inverse_response import InverseResponse
from agent.physics.effects.second_order import SecondOrder
from agent.physics.effects.sensor_lag import SensorLag
from agent.physics.loop_model import LoopModel
from agent.workbench.certainty.lag_within_a_sample import values_beside_a_lag
from agent.workbench.certainty.likelihood_profile import likelihood_profile
from agent.workbench.fit import fit
from agent.workbench.prediction_search import predictor
from agent.workbench.record import bare_record
from agent.workbench.session import Workbench

DELAY, TAU, LEAD, LAG = 8.8, 12.0, 2.8, 0.5
TRUE = np.array((DELAY, TAU, LEAD, LAG))


def bump_tests(samples=1200, seed=3):
    """OP that goes at random between two levels, and PV of a process behind a lag of ``LAG`` samples."""
    rng = np.random.default_rng(seed)
    op = 50 + 3 * np.repeat(rng.choice((-1.0, 1.0), samples // 12), 12)
    record = bare_record(LoopWindow("made", 0.0, 1.0, op, op))
    model = LoopModel(Fopdt(), (InverseResponse(), SecondOrder()))
    response = model.columns(op, TRUE, record.facts)[:, 0]
    return LoopWindow("made", 0.0, 1.0, op, 60 - 1.5 * response + 0.05 * rng.standard_normal(samples))


def best_of(window, *effects):
    record = bare_record(window)
    return predictor(fit(LoopModel(Fopdt(), effects), record, record.weight), record)


def test_a_zero_that_the_profile_rules_out_is_possible_beside_a_lag():
    predicts, best = best_of(bump_tests(), InverseResponse())
    at = list(predicts.space.names).index("inverse_response.lead")
    low, high = (
        predicts.space.values(end)[at] for end in likelihood_profile(predicts.behind, best, at)[[0, -1]]
    )
    assert not low <= LEAD <= high
    leads = [predicts.space.values(each)[at] for each in values_beside_a_lag(predicts, best)]
    assert min(abs(each - LEAD) for each in leads) < 0.1


def test_the_interval_of_a_step_holds_it():
    bench = Workbench(bump_tests(), "fopdt")
    step = bench.add("inverse_response")
    lead = next(each for each in step.parameters if each.name == "inverse_response.lead")
    delay = next(each for each in step.parameters if each.name == "delay")
    assert lead.low <= LEAD <= lead.high
    assert delay.low <= DELAY <= delay.high


def test_a_model_with_both_lags_takes_no_third():
    predicts, best = best_of(bump_tests(), SecondOrder(), SensorLag())
    assert values_beside_a_lag(predicts, best).shape == (0, len(best))


@pytest.mark.parametrize("base", [each for each in BASES if not each.linear], ids=lambda each: each.name)
def test_a_balance_takes_no_lag(base):
    window = bump_tests(samples=240)
    record = bare_record(window)
    found = predictor(fit(LoopModel(base), record, record.weight), record)
    assert not len(values_beside_a_lag(*found))
