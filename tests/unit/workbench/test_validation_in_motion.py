"""A recording for validation that begins while PV still answers to an OP that nobody recorded."""

from dataclasses import replace

import numpy as np
import pytest
from loops import made

from agent.analysis.record.recording import LoopWindow
from agent.physics.effects import EFFECTS
from agent.report.comparison_text import verdict_words
from agent.workbench.design.next_test import memory
from agent.workbench.record import bare_record
from agent.workbench.session import Workbench
from agent.workbench.session.other_base import WORDS
from agent.workbench.solved.from_before import begun_in_motion
from agent.workbench.validation import rmse_on
from simulators.balances.linear_rigs import NOISE, linear_rig
from simulators.draws.open_records import open_record

HALF = 600


def halves(seed, name):
    rig = linear_rig(seed, name)
    return [LoopWindow(name, 0.0, 1.0, rig.op[at], rig.pv[at]) for at in (slice(0, HALF), slice(HALF, None))]


@pytest.mark.parametrize("seed", [1, 2])
def test_a_process_that_rings_is_fitted_and_validated_to_the_noise(seed):
    """Both halves begin in motion; with the begin at rest the errors were 0.35 and 4."""
    fitted, other = halves(seed, "spring")
    bench = Workbench(fitted, base="oscillatory", validate=other)
    assert bench.record.start.shape == (HALF, 2)  # it swings: two states
    assert bench.step.held_out.rmse == pytest.approx(NOISE, rel=0.1)
    assert bench.step.rmse_validation == pytest.approx(NOISE, rel=0.1)


def test_nothing_is_solved_for_where_a_process_has_forgotten_what_was_before():
    record = open_record(1, "prbs")
    bench = Workbench(LoopWindow("prbs", 0.0, 1.0, record.op[300:], record.pv[300:]))
    slow = replace(bench.step.fit, values=np.array([1.0, 0.5]))
    assert begun_in_motion(slow, replace(bench.record, start=None)).start is None


def test_a_model_that_fails_on_a_process_that_rings_points_to_its_base():
    found = Workbench(halves(1, "spring")[0], without=[each.family for each in EFFECTS]).comparison()
    assert found.verdict.kind == "none_of_the_known"
    assert found.verdict.lacks == (WORDS,)
    assert WORDS in verdict_words(found.verdict, found)
    assert Workbench(made(), without=[each.family for each in EFFECTS]).other_base() == ()


def test_a_lag_of_the_valve_remembers_too():
    """Five vessels in a row, of which the model has three lags: what is left is that, and not the begin."""
    fitted, other = halves(1, "vessels")
    bench = Workbench(fitted, base="oscillatory", validate=other)
    step = bench.add("actuator_lag")
    assert step.rmse_validation < 1.4 * step.held_out.rmse  # 2.7 times with the begin at rest
    moved = replace(other, pv=other.pv + np.where(np.arange(HALF) < HALF // 2, 0.0, 10.0))
    assert rmse_on(step.fit, bare_record(moved)) > 2 * step.rmse_validation  # no begin explains that


def test_the_memory_of_a_model_is_that_of_its_base_whatever_was_added():
    window = halves(1, "spring")[0]
    bench = Workbench(window, base="oscillatory", without=[each.family for each in EFFECTS])
    effect = next(each for each in EFFECTS if each.name == "second_order")
    fit = bench.step.fit
    model, values = replace(fit.model, effects=(effect,)), np.concatenate((fit.values, [4.0]))
    larger = replace(fit, model=model, values=values)
    assert memory(larger, bench.record) == memory(fit, bench.record)
