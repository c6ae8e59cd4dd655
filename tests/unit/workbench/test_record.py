import numpy as np
from loops import made

from agent.analysis.record.recording import LoopWindow
from agent.workbench.record import FEWEST_REVERSALS, bare_record, record_of


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
    t = np.arange(900.0)
    slow = LoopWindow("slow", 0.0, 1.0, 50 + 5 * np.sin(2 * np.pi * t / 400), 3 * np.sin(2 * np.pi * t / 400))
    assert f"at least {FEWEST_REVERSALS}" in record_of(slow)
    nothing = LoopWindow("gaps", 0.0, 1.0, np.full(500, np.nan), np.full(500, np.nan))
    assert "only 0 samples" in record_of(nothing)
