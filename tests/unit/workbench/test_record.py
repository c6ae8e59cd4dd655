from dataclasses import replace

import numpy as np
from loops import made

from agent.analysis.record.recording import LoopWindow
from agent.physics.effects.inverse_response import InverseResponse
from agent.workbench.record import Record, bare_record, record_of
from simulators.draws.hidden_effects import hidden_effect_plant
from simulators.draws.open_records import open_record


def test_a_gap_has_no_weight_and_op_a_line():
    window = made()
    op, pv = window.op.copy(), window.pv.copy()
    pv[300:310] = np.nan
    op[400] = np.nan
    record = bare_record(LoopWindow("gap", 0.0, 1.0, op, pv))
    assert not record.weight[300:310].any()
    assert record.weight[299] == 1
    assert record.op[400] == (op[399] + op[401]) / 2
    assert record.weight[400] == 0
    assert np.isfinite(record.pv).all()


def test_the_start_has_no_weight_unless_the_model_knows_it():
    window = made()
    assert bare_record(window).weight[0] == 0
    assert bare_record(window, from_start=True).weight[0] == 1


def test_it_says_why_nothing_can_be_said():
    still = LoopWindow("still", 0.0, 1.0, np.full(500, 50.0), np.random.default_rng(0).standard_normal(500))
    assert "OP does not move" in record_of(still)
    nothing = LoopWindow("gaps", 0.0, 1.0, np.full(500, np.nan), np.full(500, np.nan))
    assert "only 0 samples" in record_of(nothing)


def test_a_test_by_hand_is_known_and_may_have_a_zero_that_no_feedback_allows():
    record = open_record(91064, "prbs", "inverse_response")
    by_hand = bare_record(LoopWindow("prbs", 0.0, record.scenario.ts, record.op, record.pv)).facts
    loop = bare_record(made()).facts
    assert (by_hand.stepped, loop.stepped) == (True, False)
    (true,) = hidden_effect_plant(91064, "inverse_response").parameters["inverse_response.lead"]
    ((allowed,), (in_loop,)) = (
        InverseResponse().parameters(each) for each in (by_hand, replace(by_hand, stepped=False))
    )
    assert in_loop.high < true < allowed.high


def test_the_form_of_op_refuses_no_record():
    rng = np.random.default_rng(0)
    for op in (
        np.repeat([50.0, 60.0], 200),
        50 + 0.02 * np.arange(400),
        np.repeat(rng.choice([0.0, 100.0], 40), 10),
    ):
        pv = np.convolve(op, np.ones(8) / 8)[: len(op)] + 0.05 * rng.standard_normal(len(op))
        assert isinstance(record_of(LoopWindow("open", 0.0, 1.0, op, pv)), Record)


def test_op_that_stands_still_before_its_first_step_is_known():
    op = np.repeat([50.0, 60.0, 40.0], [20, 180, 200])
    record = bare_record(LoopWindow("steps", 0.0, 1.0, op, op + 0.01 * np.arange(400)))
    assert record.weight[:9].max() == 0
    assert record.weight[10:].min() == 1
