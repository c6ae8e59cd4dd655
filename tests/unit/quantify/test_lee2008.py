import pickle
from dataclasses import replace

import numpy as np
import pytest

from agent.analysis.quantify import QUANTIFIERS, quantifier
from agent.analysis.quantify.lee2008 import Lee2008
from agent.analysis.record.recording import LoopHints, LoopWindow
from tests.unit.quantify.loops import FIRST_ORDER, INTEGRATOR, SECOND_ORDER, loop, swinging_op

GRID, RANDOM = Lee2008("grid"), Lee2008("random")
OP = swinging_op()
STEP = 0.2
"""1 % of the span of OP."""


def bands(found):
    return found.stiction.f_s.value, found.stiction.f_d.value


@pytest.mark.parametrize("process", [FIRST_ORDER, SECOND_ORDER])
@pytest.mark.parametrize(("f_s", "f_d"), [(4.0, 1.0), (5.0, 5.0), (6.0, 0.0)])
def test_the_friction_of_a_model_loop_comes_back(process, f_s, f_d):
    found = GRID.quantify(loop(OP, f_s, f_d, process))
    assert found.decision == "stiction"
    assert bands(found) == (pytest.approx(f_s, abs=STEP + 1e-9), pytest.approx(f_d, abs=STEP + 1e-9))
    assert found.free_run_percent > 95
    assert found.evidence > 5
    assert found.process.delay == pytest.approx(4 * 2.0, abs=2.0)


@pytest.mark.parametrize(("f_s", "f_d"), [(5.0, 5.0), (6.0, 0.0)])
def test_the_random_search_finds_the_wider_minima(f_s, f_d):
    found = RANDOM.quantify(loop(OP, f_s, f_d))
    assert found.decision == "stiction"
    assert bands(found) == (pytest.approx(f_s, abs=STEP), pytest.approx(f_d, abs=STEP))


@pytest.mark.parametrize("order", [1, 2])
def test_the_process_comes_back_in_seconds(order):
    made = FIRST_ORDER if order == 1 else SECOND_ORDER
    hints = LoopHints(order=order, delay=4)
    process = GRID.quantify(loop(swinging_op(2400), 4.0, 1.0, made, noise=0.0, hints=hints)).process
    assert process.kind == ("fopdt" if order == 1 else "sopdt")
    assert process.gain == pytest.approx(1.5, rel=0.02)
    assert process.tau == pytest.approx(-2.0 / np.log(0.9), rel=0.02)
    assert process.tau2 == (None if order == 1 else pytest.approx(-2.0 / np.log(0.7), rel=0.05))


def test_an_integrating_loop_is_fitted_by_an_integrator():
    window = loop(OP, 4.0, 1.0, INTEGRATOR, hints=LoopHints(integrating=True))
    found = GRID.quantify(window)
    assert bands(found) == (pytest.approx(4.0, abs=STEP + 1e-9), pytest.approx(1.0, abs=STEP + 1e-9))
    assert (found.process.kind, found.process.tau) == ("integrator", None)
    assert found.process.gain == pytest.approx(0.02 / 2.0, rel=0.02)


def test_zero_stiction_is_identified_as_zero():
    found = GRID.quantify(loop(OP, 0.0, 0.0))
    assert found.stiction is None
    assert found.decision == "no_stiction"
    assert found.evidence == 1.0
    assert found.free_run_percent == found.linear_percent


def test_the_random_search_distinguishes_zero_from_noise_only_by_the_evidence():
    found = RANDOM.quantify(loop(OP, 0.0, 0.0))
    assert found.decision == "no_stiction"
    assert found.stiction is None or found.stiction.s.value < 2 * STEP


def test_the_model_is_given_in_the_units_of_the_record():
    window = loop(OP, 4.0, 1.0, hints=LoopHints(delay=4))
    found = GRID.quantify(window)
    model = np.isfinite(found.model_pv)
    assert model.sum() == len(window) - 5, "only the start, before the delay is over, is not the model's"
    rest = np.sqrt(np.mean((found.model_pv - window.pv)[model] ** 2)) / np.std(window.pv)
    assert found.free_run_percent == pytest.approx(100 * (1 - rest))
    assert np.abs(window.op - found.model_mv).max() <= found.stiction.f_s.value + 1e-9


@pytest.mark.parametrize("gaps", ["op", "pv", "both"])
def test_missing_samples_do_not_move_the_answer(gaps):
    window = loop(OP, 4.0, 1.0, hints=LoopHints(order=1))
    op, pv = window.op.copy(), window.pv.copy()
    for start in range(50, 600, 110):
        if gaps in ("op", "both"):
            op[start : start + 7] = np.nan
        if gaps in ("pv", "both"):
            pv[start + 3 : start + 12] = np.nan
    found = GRID.quantify(replace(window, op=op, pv=pv))
    assert bands(found) == (pytest.approx(4.0, abs=STEP + 1e-9), pytest.approx(1.0, abs=2 * STEP + 1e-9))
    assert found.decision == "stiction"


def test_a_given_delay_and_order_are_kept():
    found = GRID.quantify(loop(OP, 4.0, 1.0, hints=LoopHints(delay=6, order=1)))
    assert (found.process.delay, found.process.kind) == (6 * 2.0, "fopdt")


def test_a_long_delay_is_found_by_its_estimate():
    found = GRID.quantify(loop(swinging_op(900), 1.0, 0.2, FIRST_ORDER._replace(delay=45), noise=0.0))
    assert found.process.delay == 45 * 2.0


def test_a_gain_of_the_wrong_sign_is_refused():
    direct = FIRST_ORDER._replace(b1=-0.15)
    window = loop(OP, 4.0, 1.0, direct, hints=LoopHints(acting="direct", delay=4, order=1))
    assert GRID.quantify(window).process.gain < 0
    wrong = GRID.quantify(window.with_hints(replace(window.hints, acting="reverse")))
    assert wrong.process is None or wrong.process.gain > 0


@pytest.mark.parametrize(
    ("op", "pv", "why"),
    [
        (np.full(600, 50.0), OP, "OP does not move"),
        (OP, np.full(600, 3.0), "PV does not move"),
        (OP[:99], OP[:99], "only 99 samples"),
        (np.full(600, np.nan), OP, "only 0 samples"),
        (
            np.where(np.arange(600) % 2, OP, np.nan),
            np.where(np.arange(600) % 2, np.nan, OP),
            "only 0 samples",
        ),
        (np.where(np.arange(600) % 2, OP, np.nan), OP, "no process"),
    ],
)
def test_what_cannot_be_measured_is_reported_not_raised(op, pv, why):
    found = GRID.quantify(LoopWindow("x", 0.0, 1.0, op, pv))
    assert found.failure.startswith(why)
    assert found.decision == "not_applicable"
    assert found.stiction is None


def test_the_same_record_gives_the_same_answer():
    window = loop(OP, 4.0, 1.0)
    assert bands(RANDOM.quantify(window)) == bands(RANDOM.quantify(window))


def test_quantifiers_are_found_by_name_and_travel_to_other_processes():
    for each in QUANTIFIERS:
        assert quantifier(each.name) is each
        assert pickle.loads(pickle.dumps(each)) == each  # noqa: S301 - our own bytes
    with pytest.raises(ValueError, match="lee2008_random"):
        quantifier("lee2009")
