"""What a record cannot show may be the cause of what another effect explains."""

import numpy as np
import pytest

from agent.analysis.record.recording import LoopWindow
from agent.workbench.checks.doubts import STANDS_FOR_OP
from agent.workbench.session import Workbench
from agent.workbench.shown.excitation import excitation_of, is_hidden_rival
from simulators.draws.open_records import open_record

TIME = np.arange(400.0)
BUMP = 50 + 5 * ((TIME > 100) & (TIME < 250))
FAMILIES = {"gain", "pv_gain", "process_dynamics", "extra_lag", "process_delay", "sensor_hysteresis"}


@pytest.mark.parametrize(
    ("op", "family", "hidden"),
    [
        (BUMP, "valve_hysteresis", True),
        (BUMP, "valve_limits", False),
        (50 + 5 * (TIME > 100), "valve_hysteresis", False),
        (50 + 5 * np.sin(TIME / 9), "valve_hysteresis", False),
    ],
)
def test_a_stem_that_sticks_is_a_hidden_rival_where_op_turns_back_once(op, family, hidden):
    assert is_hidden_rival(family, excitation_of(op)) is hidden


def decision_on(seed, truth, without=FAMILIES):
    """On a bump test of a loop that hides it."""
    record = open_record(seed, "bump", truth)
    window = LoopWindow("loop", 0.0, record.scenario.ts, record.op, record.pv)
    return Workbench(window, without=without).candidates()


def test_losses_are_no_more_than_suggested_where_a_dead_band_makes_a_bump_test_as_likely():
    decision = decision_on(91542, "asymmetric_stiction", FAMILIES - {"pv_gain"})
    assert (decision.kind, decision.effect) == ("suggested", "loss_curve")
    assert decision.lacks[-1] == "deadband, which this record cannot show, makes it as likely"


def test_a_load_step_in_place_of_a_dead_band_is_rejected_in_a_bump_test():
    """The valve does not come back to where it was: the load would step just where PV answers."""
    decision = decision_on(91158, "deadband")
    assert decision.kind == "none"
    event = next(each for each in decision.candidates if each.effect == "load_step")
    assert event.objection == STANDS_FOR_OP


def test_a_load_step_that_no_dead_band_explains_is_confirmed():
    decision = decision_on(91142, "load_step")
    assert (decision.kind, decision.effect) == ("confirmed", "load_step")


def test_a_wave_beside_which_a_dead_band_explains_what_remains_is_confirmed():
    decision = decision_on(91162, "stiction_sinusoid")
    assert (decision.kind, decision.effect) == ("confirmed", "sinusoid")
    assert "deadband" in decision.lacks[-1]
