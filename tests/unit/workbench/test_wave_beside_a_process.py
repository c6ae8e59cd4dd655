"""A wave that the base stands for: eleven minutes of a bump test, where its free run takes an integrator."""

import numpy as np
import pytest

from agent.analysis.record.recording import LoopWindow
from agent.physics.bases import Fopdt
from agent.physics.effects import EFFECTS
from agent.physics.effects.sinusoid import Sinusoid
from agent.physics.loop_model import LoopModel
from agent.workbench.first.first_fit import first_fit
from agent.workbench.fit import fit, fit_from
from agent.workbench.prediction_search import predictor
from agent.workbench.record import bare_record
from agent.workbench.session import Workbench
from simulators.draws.open_records import open_record

OTHERS = {each.family for each in EFFECTS} - {"disturbance"}
TAU, CYCLES = 11.8, 6.53
"""Of the process, samples, and of the wave in the record (seed 91369)."""
SLOWER = 0.01
"""A frequency, cycles a sample, from which the free run with the wave keeps the integrator."""


def window_of(seed):
    record = open_record(seed, "bump", "sinusoid")
    return LoopWindow("loop", 0.0, record.scenario.ts, record.op, record.pv)


def test_the_search_begins_where_the_smaller_model_predicts_best_too():
    bench = Workbench(window_of(91369), without=OTHERS)
    base, last = bench.auto()
    assert base.fit.values[1] > 20 * TAU  # its free run integrates, for that goes with the wave
    assert last.fit.values[1] == pytest.approx(TAU, rel=0.2)
    assert last.fit.values[2] * bench.record.facts.duration == pytest.approx(CYCLES, rel=0.02)
    assert (last.added, bench.comparison().verdict.kind) == ("sinusoid", "no_failure_visible")


def test_a_larger_model_predicts_no_worse_than_its_first_fit_though_its_free_run_is_in_a_wrong_valley():
    record = bare_record(window_of(91369))
    smaller = fit(LoopModel(Fopdt()), record, record.weight)
    predicts, best = predictor(smaller, record)
    larger = fit_from(LoopModel(Fopdt(), (Sinusoid(),)), record, np.array([*smaller.values, SLOWER]))
    assert larger.values[1] > 20 * TAU
    nested = first_fit(predicts, best, Sinusoid())
    found = predictor(larger, record, nested)
    assert found[0].variance(found[1]) < 1.01 * predicts.variance(best)


def test_a_slow_line_with_most_of_what_is_slow_is_certain_though_it_is_low_beside_a_wrong_process():
    """Five cycles in a bump test, 98 % of the held-out error, 0.79 of what is slow."""
    decision = Workbench(window_of(91355), without=OTHERS).candidates()
    assert (decision.kind, decision.effect) == ("confirmed", "sinusoid")
