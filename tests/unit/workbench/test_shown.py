"""What a record can show of each effect, and blocks that each hold some of what tells."""

import numpy as np
import pytest
from loops import made, slack

from agent.analysis.record.recording import LoopWindow
from agent.physics.bases import Fopdt
from agent.physics.effects import EFFECTS
from agent.workbench.folds import FOLDS, folds_of
from agent.workbench.hooks import silent
from agent.workbench.library import library
from agent.workbench.session.opening import opened
from agent.workbench.shown.excitation import excitation_of, not_excited
from agent.workbench.shown.information import shown_by
from agent.workbench.shown.leverage import leverage_of
from agent.workbench.shown.score import SELDOM, WORTH_A_FIT, Scores, scores_of, worth_a_fit
from agent.workbench.step import step_of
from agent.workbench.verdict import ran_out
from simulators.draws.open_records import OPEN_KINDS, open_record

LINEAR = library(EFFECTS, Fopdt())


def shown(op, pv):
    trials, alone = opened(LoopWindow("loop", 0.0, 1.0, op, pv), Fopdt(), map, silent)
    return trials, alone, {each.effect: each for each in shown_by(*alone.predicts, LINEAR)}


def test_words_of_what_op_did():
    ramp = excitation_of(np.linspace(0.0, 10.0, 300))
    assert not_excited("valve_hysteresis", ramp) == "OP never turns back"
    assert not_excited("valve_limits", ramp) is None
    step = excitation_of(np.repeat([0.0, 1.0, 0.0, 1.0], 50))
    assert "only 2 levels" in not_excited("valve_characteristic", step)
    assert "only 2 levels" in not_excited("valve_hysteresis", step)
    bump = excitation_of(np.repeat([0.0, 1.0, 0.0], 50))
    assert not_excited("valve_hysteresis", bump) is None
    assert "only 2 levels" in not_excited("valve_limits", bump)
    assert not_excited("extra_lag", step) is None


@pytest.mark.bench  # the accuracy on one draw
def test_a_process_that_ran_out_is_given_an_integrator_though_no_score_hints_at_it():
    record = open_record(91110, "prbs", "integrating")
    trials, alone, _ = shown(record.op, record.pv)
    assert scores_of(LINEAR, *alone.predicts)["integrating"] < WORTH_A_FIT
    step = step_of(alone, trials.record, None)
    assert ran_out(step, trials.record.facts) == ("tau",)
    assert "integrating" in trials.all_on(step, LINEAR).models


@pytest.mark.parametrize("kind", OPEN_KINDS)
def test_records_in_manual_show_dynamics_and_only_steps_of_many_heights_a_curve(kind):
    record = open_record(11, kind)
    _, _, found = shown(record.op, record.pv)
    can = {name for name, each in found.items() if each.why_not is None}
    assert {"integrating", "inverse_response", "rate_limit", "load_step"} <= can
    assert ("characteristic" in can) == (kind == "steps")
    assert ("deadband" in can) == (kind in {"steps", "bump"})


def test_in_a_loop_that_swings_all_is_shown_and_a_small_op_beside_loud_noise_shows_nothing():
    window = made()
    assert all(each.why_not is None for each in shown(window.op, window.pv)[2].values())
    loud = made(noise=60.0)
    _, _, found = shown(loud.op, loud.pv)
    assert "of the noise at most" in found["sensor_lag"].why_not
    assert found["sensor_lag"].information < found["deadband"].information + 10


def test_steps_show_a_titration_wherever_op_lies():
    record = open_record(68102, "steps", "titration")
    assert shown(record.op, record.pv)[2]["titration"].why_not is None


def test_one_bump_is_in_every_fold():
    record = open_record(11, "bump")
    trials, alone, _ = shown(record.op, record.pv)
    folds = folds_of(trials.record, alone.fit)
    share = leverage_of(alone.fit, trials.record)
    assert share.sum() == pytest.approx(1.0)
    assert min(share[folds.held_out(fold)].sum() for fold in range(FOLDS)) > 0.02
    assert np.bincount(folds.block[folds.block >= 0]).min() >= 3


def test_what_is_missing_is_fitted_and_what_nothing_goes_along_with_is_not():
    window = slack()
    _, alone, _ = shown(window.op, window.pv)
    scores = Scores(*alone.predicts)
    kept = worth_a_fit(LINEAR, alone.predicts)
    families = {each.family for each in kept}
    assert "valve_hysteresis" in families
    assert {"inverse_response", "integrating"} <= {each.name for each in kept}  # which dead time may hide
    assert len(kept) < len(LINEAR)
    best = {name: max(scores.of(each) for each in LINEAR if each.family == name) for name in families}
    assert max(best, key=best.get) == "valve_hysteresis"
    missed = [each for each in LINEAR if each.family not in families]
    assert max(scores.of(each) for each in missed) < max(WORTH_A_FIT, *best.values())
    assert SELDOM.isdisjoint(each.name for each in worth_a_fit(LINEAR, None))
