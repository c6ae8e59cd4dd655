"""What the residual's spectrum says of a wave, where an autoregression hides it from the innovations."""

from agent.analysis.record.recording import LoopWindow
from agent.physics.effects import EFFECTS
from agent.workbench.checks.wave_lines import NO_HARMONICS, SLOW_LINE
from agent.workbench.session import Workbench
from simulators.draws.open_records import open_record

OTHERS = {each.family for each in EFFECTS} - {"disturbance"}


def decision_on(seed, truth, kind="bump"):
    record = open_record(seed, kind, truth)
    window = LoopWindow("loop", 0.0, record.scenario.ts, record.op, record.pv)
    return Workbench(window, without=OTHERS).candidates()


def test_a_slow_wave_with_a_certain_line_is_confirmed_though_the_innovations_hardly_fall():
    """Eight cycles in a bump test, 91 % of the residual: the verdict was *none of the known effects*."""
    decision = decision_on(91159, "sinusoid")
    assert (decision.kind, decision.effect, decision.indistinguishable) == ("confirmed", "sinusoid", ())


def test_a_slow_line_that_noise_may_have_made_is_suggested_where_nothing_else_can_be_named():
    """Three cycles in a bump test of a load that wanders, and no such wave in the loop."""
    decision = decision_on(91160, "pv_gain")
    assert (decision.kind, decision.effect) == ("suggested", "sinusoid")
    assert decision.lacks == (SLOW_LINE,)
    assert next(each for each in decision.candidates if each.effect == "sinusoid").objection == SLOW_LINE


def test_a_wave_with_harmonics_that_gain_nothing_is_a_sinusoid():
    decision = decision_on(91162, "stiction_sinusoid")
    assert decision.effect == "sinusoid"
    objections = {each.effect: each.objection for each in decision.candidates}
    assert objections["wave"] == NO_HARMONICS


def test_a_slow_wave_that_only_the_innovations_show_is_slow_noise():
    """Five cycles in a record that hides nothing, p = 3e-5: thirty lags know nothing of so slow a cycle."""
    decision = decision_on(91888, "none", "prbs")
    assert (decision.kind, decision.effect, decision.lacks) == ("suggested", "sinusoid", (SLOW_LINE,))
