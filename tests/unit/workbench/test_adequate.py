"""What remains with an effect: noise, another effect of the library, or what is not in it."""

from dataclasses import replace

import numpy as np
import pytest
from loops import slack

from agent.analysis.record.recording import LoopWindow
from agent.physics.bases import Fopdt
from agent.physics.effects import EFFECTS
from agent.workbench.checks.adequate import NOT_IN_LIBRARY
from agent.workbench.checks.remainder import remainder
from agent.workbench.hooks import silent
from agent.workbench.hypotheses import CONFIRMED
from agent.workbench.residual.very_strong import VERY_STRONG
from agent.workbench.session import Workbench
from agent.workbench.session.opening import opened
from agent.workbench.step import step_of
from benchmarks.cases.hidden_case import drawn
from simulators.draws.open_records import open_record
from simulators.field import response
from simulators.parameters import Drift, Wander

NAMED = {each.name: each for each in EFFECTS}


def judged(record, *families):
    """The decision on an open record by a library of these families."""
    window = LoopWindow("loop", 0.0, record.scenario.ts, record.op, record.pv)
    return Workbench(window, without={each.family for each in EFFECTS} - set(families)).candidates()


@pytest.fixture(scope="module")
def band():
    """A loop with a dead band: what was opened, the base, and the model with the band alone."""
    trials, alone = opened(slack(noise=0.02), Fopdt(), map, silent)
    base = step_of(alone, trials.record, None)
    return base, trials.judged_on(base, [NAMED["deadband"], NAMED["rate_limit"]])


def test_the_true_effect_leaves_noise_and_the_model_without_it_and_a_wrong_one_do_not(band):
    base, found = band
    assert remainder(*found.models["deadband"].predicts) <= VERY_STRONG
    assert remainder(*base.predicts) > VERY_STRONG
    assert remainder(*found.models["rate_limit"].predicts) > VERY_STRONG
    assert (found.decision.kind, found.decision.effect, found.decision.lacks) == ("confirmed", "deadband", ())


def test_a_trim_that_stands_for_a_curve_behind_the_lags_is_suggested():
    record = open_record(91127, "steps", "pv_gain")
    decision = judged(record, "valve_characteristic")
    assert (decision.kind, decision.family) == ("suggested", "valve_characteristic")
    assert NOT_IN_LIBRARY in decision.lacks
    named = judged(record, "valve_characteristic", "pv_gain")
    assert named.kind in CONFIRMED
    assert (named.effect, named.lacks) == ("square_law", ())


def test_a_lag_that_stands_for_a_limited_speed_is_seen():
    """The lag lowers the error, but large moves take longer than small ones."""
    record = open_record(91702, "prbs", "rate_limit")
    alone = judged(record, "extra_lag")
    assert alone.family == "extra_lag"
    assert NOT_IN_LIBRARY in alone.lacks
    both = judged(record, "extra_lag", "valve_speed")
    assert (both.kind, both.effect, both.lacks) == ("confirmed", "rate_limit", ())


def test_a_wave_is_seen_by_itself_whatever_is_missing_beside_it():
    """An autoregression predicts it, so that with the lag it makes the record no likelier."""
    record = open_record(91700, "prbs", "sinusoid")
    found = judged(record, "disturbance", "extra_lag")
    assert (found.kind, found.effect) == ("confirmed", "sinusoid")
    assert found.lacks == ("with it sensor lag is still missing",)


@pytest.mark.bench  # the accuracy on one draw
def test_a_slow_wave_may_stand_for_an_integrator_and_a_number_at_its_bound_leaves_a_remainder():
    record = open_record(62409, "prbs", "integrating")
    quiet = record.scenario.model_copy(update={"wander": Wander(), "drift": Drift()})
    noise = np.random.default_rng(62409).normal(0, quiet.noise.std, len(record.op))
    record = replace(record, pv=response(quiet, record.op) + noise)
    window = LoopWindow("loop", 0.0, record.scenario.ts, record.op, record.pv)
    bench = Workbench(window, without={each.family for each in EFFECTS} - {"disturbance"})
    alone = bench.candidates()
    assert (alone.kind, alone.effect) == ("suggested", "sinusoid")
    assert remainder(*bench.trials.known(bench.step).models["sinusoid"].predicts) > VERY_STRONG
    named = judged(record, "disturbance", "process_dynamics")
    assert (named.kind, named.effect) == ("confirmed", "integrating")


@pytest.mark.parametrize(("bend", "alone"), [(0.03, "confirmed"), (0.3, "suggested")], ids=["trifle", "more"])
def test_what_remains_may_be_another_effect_or_a_trifle_and_lowers_nothing_then(bend, alone):
    window = slack(noise=0.02)
    away = window.pv - window.pv.mean()
    bent = replace(window, pv=window.pv + bend * away**2 / np.ptp(window.pv))
    trials, opening = opened(bent, Fopdt(), map, silent)
    base = step_of(opening, trials.record, None)
    decision = trials.judged_on(base, [NAMED["deadband"]]).decision
    assert (decision.kind, decision.effect, decision.lacks) == (alone, "deadband", (NOT_IN_LIBRARY,))
    able = trials.judged_on(base, [NAMED["deadband"]], [NAMED["pv_gain"]]).decision
    assert (able.kind, able.lacks) == ("confirmed", ("with it pv gain is still missing",))


def test_a_wave_is_confirmed_beside_a_valve_that_alone_makes_more_error():
    """However likely the valve is; and no score hints at it beside the wave."""
    _, window = drawn("stiction_sinusoid", 91688, "closed_loop")
    kept = {"sinusoid", "stiction", "asymmetric_stiction"}
    bench = Workbench(window, without=[each.name for each in EFFECTS if each.name not in kept])
    decision = bench.candidates()
    valve = next(each for each in decision.candidates if each.effect == "stiction")
    assert valve.odds > VERY_STRONG
    assert not valve.is_large
    assert (decision.kind, decision.effect) == ("confirmed", "sinusoid")
    assert "stiction is still missing" in decision.lacks[-1]
