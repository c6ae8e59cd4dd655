"""What a repair would gain, against the physical simulator with a valve that was repaired."""

from dataclasses import replace

import numpy as np
import pytest

from agent.analysis.benefit.benefit import benefit, simc
from agent.analysis.record.recording import LoopWindow
from agent.analysis.results import (
    IntervalEstimate,
    ProcessEstimate,
    ProcessIntervals,
    Quantification,
    StictionEstimate,
)
from agent.report.parts.benefit_words import benefit_json, benefit_lines
from simulators.parameters import ControllerParameters, Noise, ProcessParameters, ValveParameters, Wander
from simulators.plant import simulate
from simulators.scenario import Scenario

F_S, F_D = 3.0, 1.0
SCENARIO = Scenario(
    loop="FIC101",
    duration=1500.0,
    seed=3,
    process=ProcessParameters(gain=1.2, tau=12.0, delay=3.0),
    controller=ControllerParameters(kc=1.2, ti=9.0, sp=60.0),
    valve=ValveParameters(law="karnopp", f_s=F_S, f_d=F_D),
    noise=Noise(std=0.1),
    wander=Wander(std=0.5, correlation=60.0),
)
STICTION = StictionEstimate(
    IntervalEstimate(F_S), IntervalEstimate(F_D), IntervalEstimate(4.0, 3.8, 4.2), IntervalEstimate(2.0)
)
PROCESS = ProcessEstimate(
    "fopdt", 1.2, 12.0, 4.0, intervals=ProcessIntervals((1.1, 1.3), (11.0, 13.0), (3.0, 5.0))
)


def fitted(record):
    """The answer of a fit that found the truth: PV of the model is that of the stem."""
    level, pv = 0.0, np.empty(len(record.pv))
    for k in range(len(pv)):
        level += (1.2 * (record.mv[max(k - 3, 0)] - 50) - level) * (1 - np.exp(-1 / 12))
        pv[k] = 60 + level
    return Quantification("free_run", STICTION, PROCESS, 90.0, 60.0, 5.0, "stiction", model_pv=pv)


@pytest.fixture(scope="module")
def records():
    sound = SCENARIO.model_copy(update={"valve": ValveParameters()})
    return simulate(SCENARIO), simulate(sound)


def window_of(record):
    return LoopWindow("FIC101", 0.0, 1.0, record.op, record.pv, record.sp)


def test_the_gain_of_a_repair_is_that_of_the_repaired_plant(records):
    sticking, sound = records
    found = benefit(window_of(sticking), fitted(sticking))
    true = np.var(sound.pv) / np.var(sticking.pv)
    assert true < 0.7
    assert found.as_is.pv_variance == pytest.approx(np.var(sticking.pv), rel=0.4)
    assert found.repaired.pv_variance.ratio == pytest.approx(true, abs=0.25)
    assert (
        found.repaired.pv_variance.low <= found.repaired.pv_variance.ratio <= found.repaired.pv_variance.high
    )
    assert found.repaired.pv_variance.ratio < 1


def test_words_and_json(records):
    found = benefit(window_of(records[0]), fitted(records[0]))
    lines = list(benefit_lines(found))
    assert lines[0].startswith("a repair would give, in multiples of now: variance of PV 0.")
    written = benefit_json(found, 1.0)
    assert written["repaired"]["pv_variance"]["ratio"] == found.repaired.pv_variance.ratio
    assert written["simc"]["ti_s"] == pytest.approx(12.0)
    assert set(benefit_json(None, 1.0)) == set(written)


def test_simc_of_a_first_order_process():
    tuning = simc(PROCESS, 1.0)
    assert tuning.kc == pytest.approx(12 / (1.2 * 8))
    assert tuning.kc / tuning.ki == pytest.approx(12.0)
    level = simc(ProcessEstimate("integrator", -0.01, None, 5.0), 1.0)
    assert level.kc == pytest.approx(-10.0)
    assert level.kc / level.ki == pytest.approx(40.0)


def test_a_loop_that_does_not_repeat_its_record_gains_nothing_that_is_known(records):
    sticking = records[0]
    right = fitted(sticking)
    free = replace(right, stiction=replace(STICTION, s=IntervalEstimate(0.01)))  # no limit cycle arises
    assert benefit(window_of(sticking), right) is not None
    assert benefit(window_of(sticking), free) is None


def test_without_a_controller_that_is_known_nothing_is_said(records):
    record = records[0]
    moved = LoopWindow("X", 0.0, 1.0, np.random.default_rng(0).normal(50, 1, len(record.pv)), record.pv)
    assert benefit(moved, fitted(record)) is None


def test_without_a_process_nothing_is_said(records):
    record = records[0]
    bare = Quantification("free_run", None, None, None, None, None, "undecided")
    assert benefit(window_of(record), bare) is None
