"""The first fit of an effect: from the smaller model's best predictions, and what is fitted after it."""

from dataclasses import replace

import numpy as np
import pytest
from test_closed_loop import N, loop

from agent.analysis.record.recording import LoopWindow
from agent.identify.noise.autoregression import Innovations
from agent.physics.bases import Fopdt
from agent.physics.effects.deadband import Deadband
from agent.physics.effects.inverse_response import InverseResponse
from agent.physics.effects.load_step import LoadStepEffect
from agent.physics.effects.rate_limit import RateLimit
from agent.physics.effects.saturation import Saturation
from agent.physics.effects.second_order import SecondOrder
from agent.physics.effects.sinusoid import Sinusoid
from agent.physics.effects.stiction import Stiction
from agent.physics.loop_model import LoopModel
from agent.workbench.event_scan import instants_seen
from agent.workbench.evidence import evidence_of
from agent.workbench.first.first_fit import FirstFit, first_fit
from agent.workbench.first.gaining import gaining
from agent.workbench.fit import fit
from agent.workbench.inputs.measured_input import MeasuredInput
from agent.workbench.objective import objective_of
from agent.workbench.prediction_search import predictor
from agent.workbench.predictor import predictor_with, with_effect
from agent.workbench.record import bare_record
from agent.workbench.session import Workbench
from agent.workbench.shown.score import WORTH_A_FIT, scores_of
from agent.workbench.trial import Optimum, Trial, beside, optimum
from simulators.draws.hidden_effects import hidden_effect_plant
from simulators.draws.open_records import open_record
from simulators.draws.random_plants import random_draw
from simulators.plant import simulate


@pytest.fixture(scope="module")
def slack():
    """Predictions of a base, of a loop whose valve has slack."""
    return predicted(*loop(1, slack=0.4))


def predicted(op, pv):
    record = bare_record(LoopWindow("loop", 0.0, 1.0, op, pv))
    return predictor(fit(LoopModel(Fopdt()), record, record.weight), record)


def fitted(predictions, effect, own=None):
    predicts, best = predictions
    also = None if own is None else beside(predicts.space.values(best), own)
    return first_fit(predicts, best, effect, also)


def test_the_slack_gains_and_what_is_not_there_does_not(slack):
    found = fitted(slack, Deadband())
    assert found.criterion > 10
    assert found.values[2] == pytest.approx(0.4, rel=0.3)
    for other in (Saturation(), RateLimit()):
        assert fitted(slack, other).criterion < 0


def test_values_to_begin_from_are_used():
    """An instant, which no slope shows from another."""
    op, pv = loop(1, slack=0.0)
    predictions = predicted(op, pv + np.where(np.arange(N) > 1003, 0.5, 0.0))
    event = LoadStepEffect(steps=1)
    found = fitted(predictions, event, instants_seen(*predictions, event))
    assert found.values[2] == pytest.approx(1003, abs=3)
    assert found.criterion > fitted(predictions, event).criterion + 10


def test_an_effect_that_the_smaller_models_noise_has_learnt_gains_behind_its_own():
    """The smaller model's autoregression has learnt the jumps: a dead band is worth -31 in place of 35."""
    plant = hidden_effect_plant(91127, "stiction")
    predictions = predicted(plant.op, plant.pv)
    found = fitted(predictions, Deadband())
    larger = replace(predictions[0].objective.model, effects=(Deadband(),))
    objective = objective_of(larger, predictions[0].objective.record, predictions[0].objective.target)
    behind = replace(predictions[0].behind, model=larger, layout=objective.layout, space=objective.space)
    at = objective.space.at(found.values[np.newaxis])[0]
    learnt = len(predictions[0].pv) * np.log(predictions[0].error(predictions[1]) / behind.error(at))
    assert learnt < 0
    assert found.criterion > WORTH_A_FIT


def test_a_valve_begins_with_the_process_that_it_was_found_with():
    """In a limit cycle a dead time stands for the valve: with that of the base it seemed to be worth -43."""
    record = simulate(random_draw(88607, "stiction").scenario)
    bench = Workbench(LoopWindow("loop", 0.0, 1.0, record.op[:800], record.pv[:800]))
    (begun,) = bench.trials.begun.of(bench.step, [Stiction()])
    predicts, best = bench.step.predicts
    assert predicts.space.values(best)[0] > 2 * begun.valves[0].process["delay"]
    assert begun.first.criterion > 400


def test_a_valve_is_priced_as_the_verdict_prices_it():
    """Schwarz's price of seven numbers is 49: by it these strokes were worth -12, and none was fitted."""
    record = open_record(91712, "steps", "stiction")
    bench = Workbench(LoopWindow("loop", 0.0, 1.0, record.op, record.pv))
    (begun,) = bench.trials.begun.of(bench.step, [Stiction()])
    assert begun.first.criterion > WORTH_A_FIT
    larger = with_effect(bench.step.predicts[0], Stiction()).objective
    predicts = predictor_with(larger, begun.first.noise)
    at = larger.space.at(begun.first.values)
    found = evidence_of(bench.step, Optimum(predicts.fit(at), (predicts, at)), bench.record, 1)
    assert found.criterion == pytest.approx(begun.first.criterion, abs=10)
    whole = evidence_of(bench.step, optimum(begun), bench.record, 1)
    assert whole.criterion > begun.first.criterion - 10  # the whole search may end in a deeper valley


def test_an_inverse_response_that_dead_time_hides_is_fitted():
    """To first order the innovations show nothing of it."""
    record = open_record(91711, "steps", "inverse_response")
    bench = Workbench(LoopWindow("loop", 0.0, 1.0, record.op, record.pv))
    effects = [InverseResponse(), Saturation()]
    assert scores_of(effects, *bench.step.predicts)["inverse_response"] < 1
    assert [*bench.trials.all_on(bench.step, effects).models] == ["inverse_response"]


WHITE = Innovations(np.zeros(0), np.zeros(0), 1.0)


def trial(effect, criterion):
    first = None if criterion is None else FirstFit(np.zeros(0), criterion, WHITE)
    return Trial(None, effect, None, None, first=first)


def test_what_gains_is_fitted_with_its_kin_and_that_of_which_it_says_nothing():
    measured = MeasuredInput("FEED", np.zeros(9))
    trials = [
        trial(Deadband(), 6.0),
        trial(Stiction(), -30.0),
        trial(Saturation(), 4.0),
        trial(RateLimit(), -1.0),
        trial(Sinusoid(), -30.0),
        trial(measured, -30.0),
        trial(LoadStepEffect(), -30.0),
    ]
    named = [each.name for each in gaining(trials)]
    assert named == ["deadband", "stiction", "sinusoid", "FEED"]
    assert gaining(trials[2:4]) == [trials[2].effect]  # the best, so that there is something to see
    dynamics = trial(SecondOrder(), -1.0)
    assert gaining([dynamics, *trials])[0].name == "second_order"  # beside what gains
    assert gaining([dynamics, *trials[2:]])[0].name != "second_order"
    without = [trial(Saturation(), None), trial(RateLimit(), None)]
    assert [each.name for each in gaining(without)] == ["saturation", "rate_limit"]
