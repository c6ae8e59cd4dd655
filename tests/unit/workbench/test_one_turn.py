"""In a bump test OP turns back once: a valve that sticks does not come back to where it was."""

import numpy as np
import pytest

from agent.analysis.record.recording import LoopWindow
from agent.workbench.checks.doubts import STANDS_FOR_OP
from agent.workbench.session import Workbench
from agent.workbench.shown.excitation import excitation_of, is_untried_rival, not_excited
from simulators.draws.open_records import open_record

TIME = np.arange(400.0)
BUMP = 50 + 5 * ((TIME > 100) & (TIME < 250))
FAMILIES = {"gain", "pv_gain", "process_dynamics", "extra_lag", "process_delay", "sensor_hysteresis"}
HYSTERESIS = "valve_hysteresis"


@pytest.mark.parametrize(
    ("op", "family", "shown"),
    [
        (BUMP, HYSTERESIS, True),
        (BUMP, "valve_limits", False),
        (50 + 5 * (TIME > 100), HYSTERESIS, False),
        (50 + 5 * (np.sin(TIME / 9) > 0), HYSTERESIS, False),
        (50 + 5 * np.sin(TIME / 9), HYSTERESIS, True),
    ],
)
def test_one_turn_shows_a_stem_that_sticks_and_two_levels_alone_do_not(op, family, shown):
    assert (not_excited(family, excitation_of(op)) is None) is shown


@pytest.mark.parametrize(
    ("op", "family", "hidden"),
    [
        (BUMP, HYSTERESIS, True),
        (BUMP, "valve_limits", False),
        (50 + 5 * (TIME > 100), HYSTERESIS, False),
        (50 + 5 * np.sin(TIME / 9), HYSTERESIS, False),
    ],
)
def test_a_stem_that_sticks_is_an_untried_rival_where_op_turns_back_once(op, family, hidden):
    assert is_untried_rival(family, excitation_of(op)) is hidden


def decision_on(seed, truth, without=FAMILIES):
    """On a bump test of a loop that hides it."""
    record = open_record(seed, "bump", truth)
    window = LoopWindow("loop", 0.0, record.scenario.ts, record.op, record.pv)
    return Workbench(window, without=without).candidates()


@pytest.mark.parametrize(
    ("seed", "truth"), [(91542, "asymmetric_stiction"), (91158, "deadband"), (91117, "stiction")]
)
def test_a_valve_that_sticks_is_named_in_a_bump_test(seed, truth):
    """Losses in the pipe and a step of the load where PV answers do nearly as much."""
    decision = decision_on(seed, truth, FAMILIES - {"pv_gain"})
    assert (decision.kind, decision.family) == ("family", HYSTERESIS)
    others = {each.effect: each.criterion for each in decision.candidates if each.family != HYSTERESIS}
    assert {"load_step", "loss_curve"} <= others.keys()


def test_a_load_step_that_no_dead_band_explains_is_confirmed():
    decision = decision_on(91142, "load_step")
    assert (decision.kind, decision.effect) == ("confirmed", "load_step")


def test_a_dead_band_beside_which_a_wave_is_seen_is_named():
    decision = decision_on(91162, "stiction_sinusoid")
    assert (decision.kind, decision.family) == ("family", HYSTERESIS)


def test_losses_are_no_more_than_suggested_where_a_dead_band_that_was_not_tried_is_as_likely():
    decision = decision_on(91542, "asymmetric_stiction", {*FAMILIES, HYSTERESIS} - {"pv_gain"})
    assert (decision.kind, decision.effect) == ("suggested", "loss_curve")
    assert decision.lacks[-1] == "deadband, which was not tried, makes it as likely"


def test_a_load_step_where_pv_answers_is_rejected():
    """The valve does not come back to where it was: the load would step just there."""
    decision = decision_on(91158, "deadband", {*FAMILIES, HYSTERESIS})
    assert decision.kind == "none"
    event = next(each for each in decision.candidates if each.effect == "load_step")
    assert event.objection == STANDS_FOR_OP


def test_a_wave_beside_which_a_dead_band_that_was_not_tried_explains_what_remains_is_confirmed():
    decision = decision_on(91162, "stiction_sinusoid", {*FAMILIES, HYSTERESIS})
    assert (decision.kind, decision.effect) == ("confirmed", "sinusoid")
    assert "deadband" in decision.lacks[-1]
