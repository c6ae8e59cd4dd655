"""A valve in a loop that answers to its load is found where a scan of some hundred points misses it."""

import numpy as np
import pytest

from agent.analysis.record.recording import LoopWindow
from agent.physics.bases import Fopdt
from agent.physics.effects.asymmetric_stiction import AsymmetricStiction
from agent.physics.effects.stiction import Stiction
from agent.physics.loop_model import LoopModel
from agent.workbench.fit import SCAN, fit
from agent.workbench.prediction_search import ROUNDS, predictor
from agent.workbench.projection import target_of
from agent.workbench.record import bare_record
from agent.workbench.search import objective_of, of_last_effect, searched, spread_about, whitened
from agent.workbench.valve_scan import MOVED, valves
from simulators.draws.hidden_effects import hidden_effect_plant


@pytest.fixture(scope="module", params=[AsymmetricStiction(), Stiction()], ids=lambda each: each.name)
def scanned(request):
    """Errors, and best points, of both scans; of loops on which that of some hundred failed."""
    plant = hidden_effect_plant(
        {"asymmetric_stiction": 5334, "stiction": 5331}[request.param.name], request.param.name
    )
    record = bare_record(LoopWindow("loop", 0.0, 1.0, plant.op, plant.pv))
    predicts, best = predictor(fit(LoopModel(Fopdt()), record, record.weight), record)
    model = LoopModel(Fopdt(), (request.param,))
    target = target_of(record, record.weight, linear=True)
    objective = whitened(objective_of(model, record, target), predicts.noise)
    at = np.concatenate((best, np.full(len(objective.space) - len(best), 0.5)))
    few = searched(objective, spread_about(at, of_last_effect(objective), MOVED, SCAN), ROUNDS)
    many = min(valves(objective, at, request.param.name), key=objective.error)
    return plant, objective, few, many


def test_it_finds_what_a_scan_of_some_hundred_misses(scanned):
    _, objective, few, many = scanned
    samples = np.count_nonzero(objective.target.weight)
    assert samples * np.log(objective.error(few) / objective.error(many)) > 30


def test_the_valve_that_is_found_is_the_true_one(scanned):
    plant, objective, _, many = scanned
    valve = plant.scenario.valve
    found = dict(zip(objective.space.names, objective.space.values(many), strict=True))
    if "stiction.s" in found:
        assert found["stiction.s"] == pytest.approx(valve.f_s + valve.f_d, rel=0.15)
    else:
        assert found["asymmetric_stiction.j_down"] > 2.5 * found["asymmetric_stiction.j_up"]
        assert valve.closing == pytest.approx(4.0)
