"""What every member of QUANTIFIERS promises, whatever its method."""

import math
import pickle
from dataclasses import replace

import numpy as np
import pytest

from agent.analysis.quantify import QUANTIFIERS, quantifier
from agent.analysis.record.recording import LoopHints, LoopWindow
from agent.physics.processes import PROCESSES
from tests.unit.quantify.loops import loop, swinging_op

EACH = pytest.mark.parametrize("member", QUANTIFIERS, ids=lambda member: member.name)
HINTS = LoopHints(order=1, integrating=False, acting="reverse")
STUCK = loop(swinging_op(), 4.0, 1.0, hints=HINTS)
FREE = loop(swinging_op(), 0.0, 0.0, hints=HINTS)
N = len(STUCK)
ONE_PARAMETER = {"srinivasan2005", "stenman2003"}
"""Their valve has no kinetic friction; behind one that has they may see none (docs/methods)."""
STUCK_WITHOUT_KINETIC = loop(swinging_op(), 5.0, 0.0, hints=HINTS)


def stuck_for(member):
    """A loop of the same S whose valve the member can be."""
    return STUCK_WITHOUT_KINETIC if member.name in ONE_PARAMETER else STUCK


def numbers(found):
    """All numbers of an answer that a reader may print."""
    estimates = found.stiction and (
        found.stiction.f_s,
        found.stiction.f_d,
        found.stiction.s,
        found.stiction.j,
    )
    process = found.process and (
        found.process.gain,
        found.process.tau,
        found.process.delay,
        found.process.tau2,
    )
    numbers = [found.free_run_percent, found.linear_percent, found.evidence]
    numbers += [estimate.value for estimate in estimates or ()] + list(process or ())
    return [number for number in numbers if number is not None]


def sound(found, window):
    """Hold an answer to the rules of Quantification."""
    assert all(math.isfinite(number) for number in numbers(found))
    if found.failure is not None:
        assert found.decision == "not_applicable"
        assert (found.stiction, found.process, found.evidence) == (None, None, None)
        return
    assert found.decision in ("stiction", "no_stiction", "undecided")
    assert found.evidence >= 1
    if found.decision == "stiction":
        assert found.stiction is not None
    if found.stiction is not None:
        assert 0 <= found.stiction.f_d.value <= found.stiction.f_s.value + 1e-9
        assert found.stiction.s.value <= window.op_span * (1 + 1e-9)
    assert found.process.delay >= window.ts * (1 - 1e-9)
    assert found.model_mv.shape == found.model_pv.shape == (len(window),)


@EACH
def test_it_distinguishes_a_sticking_valve_from_a_free_one(member):
    stuck, free = member.quantify(stuck_for(member)), member.quantify(FREE)
    sound(stuck, STUCK)
    sound(free, FREE)
    assert (stuck.decision, free.decision) == ("stiction", "no_stiction")
    assert stuck.quantifier == free.quantifier == member.name
    assert stuck.stiction.s.value == pytest.approx(5.0, abs=0.1 * STUCK.op_span)


@EACH
def test_it_is_found_by_name_and_travels_to_other_processes(member):
    assert quantifier(member.name) is member
    assert pickle.loads(pickle.dumps(member)) == member  # noqa: S301 - our own bytes


@EACH
def test_the_input_is_untouched_and_the_answer_repeats(member):
    before = STUCK.op.copy(), STUCK.pv.copy()
    first, second = member.quantify(STUCK), member.quantify(STUCK)
    np.testing.assert_array_equal(before, (STUCK.op, STUCK.pv))
    assert numbers(first) == numbers(second)


@EACH
@pytest.mark.parametrize(
    ("op_gain", "op_level", "pv_gain", "pv_level"), [(0.02, -1, 40, -5e3), (250, 0, 0.1, 7)]
)
def test_units_and_offsets_change_nothing_but_the_units(member, op_gain, op_level, pv_gain, pv_level):
    stuck = stuck_for(member)
    found = member.quantify(stuck)
    other = member.quantify(
        replace(stuck, op=op_gain * stuck.op + op_level, pv=pv_gain * stuck.pv + pv_level)
    )
    assert other.decision == found.decision
    near = {"abs": 0.01 * STUCK.op_span}
    assert other.stiction.s.value / op_gain == pytest.approx(found.stiction.s.value, **near)
    assert other.process.gain * op_gain / pv_gain == pytest.approx(found.process.gain, rel=0.03)
    assert other.free_run_percent == pytest.approx(found.free_run_percent, abs=0.5)


@EACH
def test_a_process_that_is_upside_down_is_the_same_loop(member):
    hints = replace(HINTS, acting="direct")
    stuck = stuck_for(member)
    found = member.quantify(replace(stuck, pv=200 - stuck.pv, hints=hints))
    assert found.decision == "stiction"
    assert found.process.gain == pytest.approx(-member.quantify(stuck).process.gain, rel=0.03)


@EACH
@pytest.mark.parametrize(
    "hints",
    [
        LoopHints(integrating=True),
        LoopHints(delay=1),
        LoopHints(delay=300, order=2),
        LoopHints(delay=N, order=1),
        LoopHints(acting="direct"),
    ],
    ids=["integrating", "delay 1", "half the record", "the whole record", "direct"],
)
def test_hints_that_do_not_fit_are_obeyed_and_do_no_harm(member, hints):
    found = member.quantify(STUCK.with_hints(hints))
    sound(found, STUCK)
    if found.process is not None:
        if hints.integrating:
            assert found.process.kind == "integrator"
        if hints.delay:
            assert found.process.delay == pytest.approx(hints.delay * STUCK.ts)
        if hints.acting:
            assert found.process.gain <= 0


def answer(op):
    """PV of a free valve."""
    return 100 + PROCESSES[0].respond(op, (10.0, 3.0))


def storms():
    random = np.random.default_rng(5)
    some = random.random(N) < 0.5
    nan, op, pv = np.nan, STUCK.op, STUCK.pv
    yield "all NaN", np.full(N, nan), np.full(N, nan)
    yield "no PV", op, np.full(N, nan)
    yield "constant OP", np.full(N, 42.0), pv
    yield "constant PV", op, np.full(N, 3.0)
    yield "20 samples", op[:20], pv[:20]
    yield "one sample", op[:1], pv[:1]
    yield "nothing", op[:0], pv[:0]
    yield "OP and PV never together", np.where(some, op, nan), np.where(some, nan, pv)
    yield "19 of 20 missing", np.where(random.random(N) < 0.05, op, nan), pv
    yield "known only at the end", np.where(np.arange(N) > N - 30, op, nan), pv
    step, ramp = np.where(np.arange(N) < N / 2, 40.0, 60.0), np.linspace(40.0, 60.0, N)
    yield "OP a step", step, answer(step)
    yield "OP a noisy step", step, answer(step) + 0.1 * random.standard_normal(N)
    yield "OP a ramp", ramp, answer(ramp)
    yield "OP a ramp that PV does not lag", ramp, 10 + 15 * ramp
    yield "OP a noisy ramp", ramp, answer(ramp) + 0.05 * random.standard_normal(N)


@EACH
@pytest.mark.parametrize(("op", "pv"), [pytest.param(op, pv, id=name) for name, op, pv in storms()])
def test_a_storm_is_never_a_sticking_valve_nor_an_exception(member, op, pv):
    window = LoopWindow("storm", 0.0, 1.0, op, pv)
    found = member.quantify(window)
    sound(found, window)
    assert found.decision != "stiction"


def odd_records():
    random = np.random.default_rng(6)
    op, pv = STUCK.op, STUCK.pv
    three = 50 + 10 * np.round((op - 50) / 10)
    scattered = np.isin(np.arange(N), random.choice(N, 80, replace=False))
    block = (np.arange(N) >= 200) & (np.arange(N) < 280)
    yield "three values of OP", three, pv
    yield "three values of OP, PV its answer", three, answer(three) + 0.01 * random.standard_normal(N)
    yield "OP moves three times", 50 + 0.1 * np.isin(np.arange(N), [100, 250, 400]), pv
    yield "two values of PV", op, np.where(pv > pv.mean(), 1.0, 0.0)
    yield "60 samples", op[:60], pv[:60]
    yield "80 scattered samples", np.where(scattered, op, np.nan), np.where(scattered, pv, np.nan)
    yield "80 samples in a row", np.where(block, op, np.nan), np.where(block, pv, np.nan)
    yield "a spike of OP", np.where(np.arange(N) == 300, 1e12, op), pv
    yield "a spike of PV", op, np.where(np.arange(N) == 300, 1e12, pv)
    yield "far from zero", op + 1e9, pv - 1e9


@EACH
@pytest.mark.parametrize(("op", "pv"), [pytest.param(op, pv, id=name) for name, op, pv in odd_records()])
def test_an_odd_record_ends_in_an_answer_or_a_failure_in_words(member, op, pv):
    window = LoopWindow("odd", 0.0, 1.0, op, pv)
    sound(member.quantify(window), window)


@EACH
@pytest.mark.slow
@pytest.mark.timeout(400)
def test_20000_samples_end_in_bounded_time(member):
    window = loop(swinging_op(20_000), 4.0, 1.0, hints=HINTS)
    sound(member.quantify(window), window)


@EACH
def test_infinity_is_a_gap_like_any_other(member):
    some = np.isin(np.arange(N), [100, 101, N // 2], invert=True)
    missing = replace(STUCK, op=np.where(some, STUCK.op, np.nan), pv=np.where(some, STUCK.pv, np.nan))
    infinite = replace(STUCK, op=np.where(some, STUCK.op, np.inf), pv=np.where(some, STUCK.pv, -np.inf))
    assert numbers(member.quantify(infinite)) == numbers(member.quantify(missing))


@EACH
@pytest.mark.parametrize("scale", [1e-100, 1e-12, 1e12, 1e100])
def test_numbers_of_any_size_are_survived(member, scale):
    window = replace(STUCK, op=scale * STUCK.op, pv=scale * STUCK.pv)
    sound(member.quantify(window), window)


@EACH
def test_noise_does_not_stick(member):
    random = np.random.default_rng(3)
    window = LoopWindow("noise", 0.0, 1.0, random.standard_normal(N), random.standard_normal(N))
    found = member.quantify(window)
    sound(found, window)
    assert found.decision != "stiction"


@EACH
@pytest.mark.parametrize("share", [0.05, 0.1])
def test_single_lost_samples_do_not_change_the_verdict(member, share):
    random = np.random.default_rng(2)
    for window, verdict in ((stuck_for(member), "stiction"), (FREE, "no_stiction")):
        op, pv = window.op.copy(), window.pv.copy()
        op[random.random(N) < share / 2] = np.nan
        pv[random.random(N) < share / 2] = np.nan
        assert member.quantify(replace(window, op=op, pv=pv)).decision == verdict
