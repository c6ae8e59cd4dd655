"""What the innovations say for and against an effect, and which of two rivals they drop."""

import numpy as np
import pytest
from scipy import stats
from test_closed_loop import N, answered_more, loop

from agent.analysis.record.recording import LoopWindow
from agent.identify.noise.autoregression import Innovations, innovations
from agent.physics.bases import Fopdt
from agent.physics.effects.deadband import Deadband
from agent.physics.effects.gain_change import GainChange
from agent.physics.effects.load_step import LoadStepEffect
from agent.physics.effects.sinusoid import Sinusoid
from agent.physics.effects.stiction import Stiction
from agent.physics.loop_model import LoopModel
from agent.workbench.evidence import VALVES, evidence_of
from agent.workbench.first.first_fit import first_fit
from agent.workbench.fit import fit, nested_fit
from agent.workbench.folds import HeldOut
from agent.workbench.innovations import likelihood_ratio
from agent.workbench.prediction_search import predictor
from agent.workbench.record import bare_record
from agent.workbench.residual.very_strong import VERY_STRONG, very_strong
from agent.workbench.trial import Tried
from benchmarks.cases.decoy import Decoy

CANDIDATES = 14
VALUES = 7
"""Of a valve that sticks."""


@pytest.fixture(scope="module")
def changed():
    """A loop of which OP moves PV by 40 % more from sample 1000 on."""
    op, pv = loop(1, slack=0.0)
    more = answered_more(op, np.arange(N) > 1000)
    record = bare_record(LoopWindow("loop", 0.0, 1.0, op, pv + more))
    return model_on(record), record


def model_on(record):
    base = fit(LoopModel(Fopdt()), record, record.weight)
    return Tried(base, predictor(base, record), blank(base))


def blank(model):
    return HeldOut(np.zeros(0), np.zeros((0, 2)), model.pv)


def evidence(effect, base, record):
    return evidence_of(base, with_effect(effect, base, record), record, CANDIDATES)


def with_effect(effect, base, record):
    model = nested_fit(base.fit.values, LoopModel(Fopdt(), (effect,)), record)
    first = first_fit(*base.predicts, effect)
    return Tried(model, predictor(model, record, first), blank(model))


def test_it_is_for_what_changed_and_not_for_what_stands_in_for_it(changed):
    found = {each.name: evidence(each, *changed) for each in (GainChange(), LoadStepEffect(), Deadband())}
    assert found["gain_change"].plain
    assert found["gain_change"].by_chance < 1e-10
    assert found["deadband"].odds < 0
    assert found["gain_change"].criterion - found["load_step"].criterion > VERY_STRONG


def test_an_instant_pays_once_more_than_any_other_number(changed):
    base, record = changed
    larger = with_effect(GainChange(), base, record)
    before, after = (
        innovations(predicts.left(best), longest=True) for predicts, best in (base.predicts, larger.predicts)
    )
    numbers = [len(each.fit.values) + len(each.fit.coefficients) for each in (base, larger)]
    price = (numbers[1] - numbers[0] + 1) * np.log(np.count_nonzero(np.isfinite(before.values)))
    found = evidence_of(base, larger, record, CANDIDATES)
    assert found.criterion == pytest.approx(likelihood_ratio(before, after) - price)


def test_a_step_of_a_loop_without_one_is_chance():
    op, pv = loop(2, slack=0.0)
    record = bare_record(LoopWindow("loop", 0.0, 1.0, op, pv))
    assert evidence(LoadStepEffect(), model_on(record), record).by_chance > 0.05


@pytest.mark.parametrize(("height", "there"), [(0.0, False), (3.0, True)])
def test_a_walk_must_show_in_the_innovations(height, there):
    """Walks go along with a slow load by chance; a load that was measured does so sample by sample."""
    walk = Decoy(4)
    op, pv = loop(5, slack=0.0)
    load = height * walk.columns(np.arange(N), op, np.zeros(0))[:, 0]
    record = bare_record(LoopWindow("loop", 0.0, 1.0, op, pv + load))
    found = evidence(walk, model_on(record), record)
    assert (found.odds > 0) is there
    assert (found.by_chance < 0.05) is there
    assert not found.blind  # nor are blocks that were not fitted, which the same walk crosses


@pytest.mark.parametrize(("height", "seen"), [(0.0, False), (1.0, True)])
def test_a_wave_under_a_wandering_load_is_reported_by_its_likelihood(height, seen):
    op, pv = loop(3, slack=0.0)
    load = np.std(pv - answered_more(op, np.ones(N, dtype=bool)))
    wave = height * load * np.sin(2 * np.pi * np.arange(N) / 37.0)
    record = bare_record(LoopWindow("loop", 0.0, 1.0, op, pv + wave))
    found = evidence(Sinusoid(), model_on(record), record)
    assert found.blind  # a line has one place in the spectrum
    assert (found.by_chance < 1e-6) is seen
    assert (found.by_chance == 1.0) is not seen


@pytest.mark.parametrize("slack", [0.0, 0.4])
def test_the_price_of_a_stems_constants_is_what_the_record_reports_of_them(slack):
    """Schwarz takes each for told by every sample, and hides a small valve."""
    op, pv = loop(1, slack=slack)
    record = bare_record(LoopWindow("loop", 0.0, 1.0, op, pv))
    base = model_on(record)
    found = evidence(Stiction(), base, record)
    assert very_strong(found.criterion, CANDIDATES) == bool(slack)
    likelier = stats.chi2.isf(found.by_chance / (CANDIDATES * VALVES), VALUES) if slack else 0.0
    assert not very_strong(likelier - VALUES * np.log(N), CANDIDATES)


def test_what_explains_a_burst_is_no_proof():
    """Three wild innovations of 600: less than three of the normal distribution would be."""
    white = np.random.default_rng(3).standard_normal(600)
    wild = white.copy()
    wild[300:303] = (9.0, -8.0, 7.0)
    ratio = likelihood_ratio(Innovations(wild, np.zeros(0), wild.var()), Innovations(white, np.zeros(0), 1.0))
    assert 0 < ratio < 0.5 * len(white) * np.log(wild.var() / white.var())


def test_a_smaller_scale_counts_as_much_as_of_the_normal_distribution():
    one, other = (scale * np.random.default_rng(4).standard_normal(4000) for scale in (1.1, 1.0))
    ratio = likelihood_ratio(*(Innovations(each, np.zeros(0), each.var()) for each in (one, other)))
    assert ratio == pytest.approx(4000 * np.log(1.1**2), rel=1e-3)


def test_what_is_rounding_is_alike():
    one, other = (scale * np.random.default_rng(4).standard_normal(400) for scale in (1e-9, 1e-10))
    ones, others = (Innovations(each, np.zeros(0), each.var()) for each in (one, other))
    assert likelihood_ratio(ones, others, least=1e-12) == pytest.approx(0.0, abs=1e-2)
