"""PV does not respond to OP: records by hand, each cause, and what is never said."""

import numpy as np
import pytest

from agent.analysis.diagnose import diagnose
from agent.analysis.record.known_process import KnownProcess
from agent.analysis.record.recording import LoopHints, LoopWindow
from agent.analysis.response.candidates import LikelyProcess
from agent.analysis.response.evidence_of_response import evidence_of_response
from agent.analysis.response.no_response import no_response
from agent.analysis.routine import routine_diagnosis
from agent.report.advice import advice
from agent.report.diagnosis_json import diagnosis_json
from agent.report.parts.no_response_words import no_response_words
from agent.report.reasons import reasons
from simulators.draws.random_cascades import random_cascade
from simulators.plant import simulate
from tests.unit.analysis.diagnoses import HEALTHY, Told

N = 1200
KNOWN = LoopHints(known=KnownProcess(gain=1.5, tau=10.0, delay=3.0, log_gain_sd=0.3))
NOISE = 0.2 * np.random.default_rng(1).normal(size=N)
STEPS = 50 + np.where(np.arange(N) // 150 % 2, 12.0, 0.0)
"""OP that somebody moves to and fro."""


def window(op, pv, hints=KNOWN):
    return LoopWindow("FIC101", 0.0, 1.0, op=op, pv=pv, hints=hints)


def responding(op):
    pv, level = np.empty(N), 0.0
    for k in range(N):
        level += (1.5 * (op[max(k - 3, 0)] - 50) - level) / 10
        pv[k] = 80 + level
    return pv


def test_a_measured_pv_that_stands_while_op_steps_does_not_respond():
    found = no_response(window(STEPS, 80 + NOISE))
    assert found is not None
    assert found.cause == "unknown"
    assert found.op_travel == pytest.approx(12.0, abs=0.1)
    assert found.op_spans == pytest.approx(0.12, abs=0.01)
    assert found.expected == pytest.approx(18.0, rel=0.1)
    assert found.deviations > 20


def test_a_pv_that_follows_responds():
    assert no_response(window(STEPS, responding(STEPS) + NOISE)) is None


def test_a_load_that_op_cancels_is_no_missing_response():
    load = np.cumsum(np.random.default_rng(2).normal(size=N)) * 0.5
    op = 50 - np.concatenate((np.zeros(3), load[:-3]))
    assert np.ptp(op) > 5
    pv = responding(op) + 1.5 * (load - load[0]) * 0 + NOISE
    steady = 80 + NOISE + 0.02 * (load - load.mean())
    assert no_response(window(op, pv)) is None
    assert no_response(window(op, steady, LoopHints())) is None


def test_a_quiet_op_says_nothing():
    op = 50 + np.where(np.arange(N) // 150 % 2, 2.0, 0.0)
    assert no_response(window(op, 80 + NOISE)) is None
    assert no_response(window(op, np.full(N, 80.0))) is None


def test_an_exactly_constant_pv_is_a_dead_transmitter():
    pv = responding(STEPS) + NOISE
    pv[400:] = pv[400]
    found = no_response(window(STEPS, pv, LoopHints()))
    assert found is not None
    assert (found.cause, found.begin) == ("dead_transmitter", 400)


def test_a_pv_that_fell_to_zero_is_no_flow():
    pv = responding(STEPS) + NOISE
    pv[400:] = pv[400] * np.exp(-np.arange(N - 400) / 10)
    pv[pv < 0.5] = 0.0
    found = no_response(window(STEPS, pv))
    assert found is not None
    assert found.cause == "no_flow"


def test_a_slip_at_the_end_is_a_stuck_valve():
    op = STEPS + np.linspace(0.0, 20.0, N)
    pv = 80 + NOISE
    pv[1100:] += 15.0
    found = no_response(window(op, pv))
    assert found is not None
    assert found.cause == "stuck_valve"
    assert found.end == pytest.approx(1100, abs=5)
    down = 80 + NOISE
    down[1100:] -= 15.0
    assert no_response(window(op, down)).cause == "unknown"


def test_without_a_known_process_it_is_not_stated_of_a_measured_pv_of_an_unlawful_op():
    assert no_response(window(STEPS, 80 + NOISE, LoopHints())) is None


def test_gaps_are_skipped():
    pv = 80 + NOISE
    pv[:150] = np.nan
    found = no_response(window(STEPS, pv))
    assert found is not None
    assert found.begin >= 150
    assert no_response(window(STEPS, np.full(N, np.nan))) is None


def judged(record):
    return diagnose(record, quantifier=Told(HEALTHY))


def test_the_diagnosis_has_it_in_json_reasons_and_advice():
    said = judged(window(STEPS, 80 + NOISE))
    assert said.no_response is not None
    assert said.verdict in ("undecided", "not_testable")
    found = diagnosis_json(said, "FIC101.csv")["no_response"]
    assert found["found"]
    assert found["cause"] == "unknown"
    assert set(found["possible"]) == {"stuck_valve", "block_valve_closed", "by_pass_open"}
    assert "PV does not respond to OP: OP travelled 12 % of its range" in reasons(said)[0]
    assert "position of the stem" in advice(said)[0]


def test_a_routine_window_in_which_pv_does_not_respond_is_not_called_sound():
    op = 50 + 10 * np.minimum(np.arange(N) // 300, 2)
    found = routine_diagnosis(window(op + 0.0, 80 + NOISE), lambda record, _=None: judged(record)).diagnosis
    assert found.no_response is not None
    assert found.verdict != "no_stiction"


def test_json_of_a_loop_that_responds_has_every_key():
    said = judged(window(STEPS, responding(STEPS) + NOISE))
    found = diagnosis_json(said, "x")["no_response"]
    assert found["found"] is False
    assert {key for key, value in found.items() if value} == set()


def test_a_pv_that_is_exactly_zero_from_one_sample_to_the_next_may_be_either():
    pv = responding(STEPS) + NOISE
    pv[400:] = 0.0
    found = no_response(window(STEPS, pv))
    assert found is not None
    assert found.cause == "no_signal_or_flow"
    assert "transmitter" in no_response_words(found)
    assert "pump" in no_response_words(found)


def test_a_flow_that_stopped_with_noise_cut_off_at_zero_is_found():
    pv = responding(STEPS) + 8 * NOISE
    pv[400:] = np.maximum(8 * NOISE[400:] + 100 * np.exp(-np.arange(N - 400) / 10), 0.0)
    found = no_response(window(STEPS, pv))
    assert found is not None
    assert found.cause == "no_flow"


TURN = 700
RAMP = 50 + np.where(np.arange(N) < TURN, np.arange(N) * 0.03, (2 * TURN - np.arange(N)) * 0.03)
"""OP that ramps, and turns when the stem slips."""


def test_a_ramp_alone_says_nothing_but_one_that_turned_where_pv_slipped_does():
    stem = 80 + np.where(np.arange(N) < TURN, 0.0, 15.0) + NOISE
    before = slice(0, TURN)
    known = KNOWN.known
    process = LikelyProcess(known.gain, known.log_gain_sd, known.tau, int(known.delay))
    alone = evidence_of_response(RAMP, stem, [process], [before])
    both = evidence_of_response(RAMP, stem, [process], [before, slice(TURN, N)])
    assert alone.log_ratio < 4
    assert both.log_ratio > alone.log_ratio + 10
    found = no_response(window(RAMP, stem))
    assert found is not None
    assert found.cause == "stuck_valve"


def test_a_load_that_steps_while_pv_follows_is_no_stuck_valve():
    load = np.where(np.arange(N) < TURN, 0.0, 15.0)
    assert no_response(window(RAMP, responding(RAMP) + load + NOISE)) is None


def test_a_plug_that_jams_in_the_middle_of_a_quiet_record_is_found():
    rng = np.random.default_rng(7)
    op = 50 + np.where(np.arange(N) < 500, 0.3 * np.sin(np.arange(N) / 9), STEPS - 50)
    pv = responding(op)
    pv[500:] = pv[499]
    found = no_response(window(op, pv + 0.2 * rng.normal(size=N)))
    assert found is not None
    assert found.cause == "unknown"


def test_a_sticking_valve_that_is_called_stuck_stood_while_op_travelled_and_then_slipped():
    """The only one of 24 sticking loops that `docs/methods/no_response.md` speaks of."""
    scenario = random_cascade(62001, "cascade_stiction")
    record = simulate(scenario)
    found = no_response(LoopWindow("TIC1", 0.0, scenario.ts, record.op, record.pv, record.sp))
    assert found is not None
    assert found.cause == "stuck_valve"
    stem = record.mv[found.begin : found.end - 1]  # the last sample is that of the slip
    assert np.ptp(stem) < 0.01
    assert np.ptp(record.op[found.begin : found.end]) > 7
    assert abs(record.mv[found.end + 2] - stem[-1]) > 3
