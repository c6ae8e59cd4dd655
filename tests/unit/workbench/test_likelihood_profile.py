import numpy as np
import pytest
from loops import S, made, slack

from agent.analysis.record.recording import LoopWindow
from agent.physics.bases import Fopdt
from agent.physics.bases.linear_process import lagged
from agent.physics.effects.deadband import Deadband
from agent.physics.loop_model import LoopModel
from agent.workbench.certainty.free_memory import with_free_memory
from agent.workbench.certainty.likelihood_profile import likelihood_profile
from agent.workbench.fit import fit, nested_fit
from agent.workbench.prediction_search import predictor
from agent.workbench.record import bare_record
from agent.workbench.session import Workbench
from agent.workbench.several.together import compared_together
from simulators.draws.open_records import open_record

VOLUME, NO_FLOW = "transport_delay.volume", "transport_delay.no_flow"
WITH_BAND = LoopModel(Fopdt(), (Deadband(),))


def ends_of(window):
    record = bare_record(window)
    base = fit(LoopModel(Fopdt()), record, record.weight)
    predicts, best = predictor(nested_fit(base.values, WITH_BAND, record), record)
    ends = np.tile(best, (3, 1))
    ends[1:] = likelihood_profile(predicts.behind, best, 2)[[0, -1]]
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
    low = predicts.space.values(likelihood_profile(freed.behind, best, at)[0])[at]
    assert low < true.no_flow
    monkeypatch.setattr("agent.workbench.certainty.likelihood_profile.PATIENCE", 0)
    assert predicts.space.values(likelihood_profile(freed.behind, best, at)[0])[at] > true.no_flow


def test_what_is_as_likely_with_another_parameter_widens_the_interval_of_each(pipe):
    step, _ = pipe
    predicts, best = step.predicts
    freed, at = with_free_memory(predicts, best), predicts.space.names.index(VOLUME)
    own = predicts.space.values(likelihood_profile(freed.behind, best, at)[-1])[at]
    found = {each.name: each for each in step.parameters}
    assert found[VOLUME].high > 2 * own


LAGS = 6.0
"""Of both lags of a process, s."""


def two_equal_lags(seed, samples=700):
    """A record in manual of two lags that are alike, with noise that wanders a little."""
    rng = np.random.default_rng(seed)
    op = 50 + 4.0 * rng.choice([-1.0, 1.0], samples // 10).repeat(10)
    late = np.concatenate((np.full(4, op[0]), op[:-4]))
    noise = 0.5 * lagged(rng.standard_normal(samples), 3.0)
    return LoopWindow("two lags", 0.0, 1.0, op, 20 + lagged(lagged(late, LAGS), LAGS) + noise)


def test_two_lags_that_are_alike_have_intervals_of_the_likelihood():
    """A change of both in opposite directions moves nothing to first order."""
    step = Workbench(two_equal_lags(1), "sopdt").step
    longer, shorter = (each for each in step.parameters if each.name in {"tau", "tau2"})
    assert shorter.low < LAGS < longer.high
    assert all(each.low <= each.value <= each.high < 2.5 * each.low for each in (longer, shorter))
    # The longer one is not what the shorter one could be.
    assert longer.low > 0.9 * shorter.high


def test_they_have_them_on_several_recordings_together():
    benches = {str(seed): Workbench(two_equal_lags(seed), "sopdt") for seed in (1, 2)}
    shared = {each.name: each for each in compared_together(benches, (), auto=False).steps[0].fitted.shared()}
    alone = {each.name: each for each in benches["1"].step.parameters}
    for name in ("tau", "tau2"):
        both, one = shared[name], alone[name]
        assert both.low <= both.value <= both.high < 2.5 * both.low
        assert both.high - both.low < one.high - one.low
        assert both.unit == "s"
