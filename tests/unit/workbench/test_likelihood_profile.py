import numpy as np
import pytest
from loops import S, made, slack

from agent.analysis.record.recording import LoopWindow
from agent.physics.bases import Fopdt
from agent.physics.effects.deadband import Deadband
from agent.physics.loop_model import LoopModel
from agent.workbench.certainty.free_memory import with_free_memory
from agent.workbench.certainty.likelihood_profile import likelihood_profile
from agent.workbench.fit import fit, nested_fit
from agent.workbench.prediction_search import predictor
from agent.workbench.record import bare_record
from agent.workbench.session import Workbench
from simulators.draws.open_records import open_record

VOLUME, NO_FLOW = "transport_delay.volume", "transport_delay.no_flow"
WITH_BAND = LoopModel(Fopdt(), (Deadband(),))


def ends_of(window):
    record = bare_record(window)
    base = fit(LoopModel(Fopdt()), record, record.weight)
    predicts, best = predictor(nested_fit(base.values, WITH_BAND, record), record)
    ends = np.tile(best, (3, 1))
    ends[1:] = likelihood_profile(predicts, best, 2)
    return predicts.space.values(ends)[:, 2]


def test_it_is_about_the_truth_and_widens_with_the_noise():
    widths = []
    for noise in (0.05, 1.0):
        best, low, high = ends_of(slack(noise=noise))
        assert low - 0.05 * S <= S <= high
        assert low <= best <= high
        widths.append(high - low)
    assert widths[0] < 0.05 * S
    assert widths[1] > 2 * widths[0]


def test_it_ends_at_nothing_where_there_is_nothing():
    _, low, high = ends_of(made(noise=0.5))
    assert low == pytest.approx(0.0)
    assert high < 1.0


@pytest.fixture(scope="module")
def pipe():
    """A pipe whose dead time a model takes for that of the process: valley beside valley in PRBS."""
    record = open_record(95283, "prbs", "transport_delay")
    bench = Workbench(LoopWindow("pipe", 0.0, record.scenario.ts, record.op, record.pv))
    return bench.add("transport_delay"), record.scenario.pipe


def test_it_goes_on_behind_a_distance_that_the_record_rejects(pipe, monkeypatch):
    step, true = pipe
    predicts, best = step.predicts
    freed, at = with_free_memory(predicts, best), list(predicts.space.names).index(NO_FLOW)
    low = predicts.space.values(likelihood_profile(freed, best, at)[0])[at]
    assert low < true.no_flow
    monkeypatch.setattr("agent.workbench.certainty.likelihood_profile.PATIENCE", 0)
    assert predicts.space.values(likelihood_profile(freed, best, at)[0])[at] > true.no_flow


def test_what_is_as_likely_with_another_parameter_widens_the_interval_of_each(pipe):
    step, _ = pipe
    predicts, best = step.predicts
    freed, names = with_free_memory(predicts, best), list(predicts.space.names)
    own = predicts.space.values(likelihood_profile(freed, best, names.index(VOLUME))[1])[names.index(VOLUME)]
    found = {each.name: each for each in step.parameters}
    assert found[VOLUME].high > 2 * own
