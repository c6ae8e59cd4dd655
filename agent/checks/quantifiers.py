"""What the contract of a quantifier demands: ``agent.analysis.quantify.Quantifier``.

A quantifier whose valve has one parameter (no kinetic friction) has an attribute ``one_parameter`` that is
True; it is checked on a valve that has no kinetic friction either.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import TYPE_CHECKING

from agent.analysis.record.recording import LoopHints, LoopWindow
from agent.checks.contract import demand, require, require_close, where
from agent.checks.detector_records import pickled
from agent.checks.quantifier_records import (
    FREE,
    HALF,
    HINTS,
    STUCK,
    STUCK_WITHOUT_KINETIC,
    loop,
    numbers,
    odd_records,
    records_of_no_valve,
    sound,
    with_gaps,
    without_stiction,
)

if TYPE_CHECKING:
    from agent.analysis.quantify import Quantifier
    from agent.analysis.results import Quantification
    from agent.checks.quantifier_records import FloatArray

ONE_PARAMETER = frozenset({"srinivasan2005", "stenman2003"})
"""Built in; behind a valve with kinetic friction they may see none (docs/methods)."""
S_TOLERANCE = 0.1
"""Of the span of OP, by which S may be off on a record without faults."""


def stuck_for(member: Quantifier) -> LoopWindow:
    """Return a loop of S = 5 OP units whose valve the member can describe."""
    one = member.name in ONE_PARAMETER or getattr(member, "one_parameter", False)
    return STUCK_WITHOUT_KINETIC if one else STUCK


class _Answers:
    """Answers of the member that is checked now on the records that several checks show it."""

    def __init__(self) -> None:
        self._member: Quantifier | None = None
        self._known: dict[int, Quantification] = {}

    def of(self, member: Quantifier, window: LoopWindow) -> Quantification:
        """Return the answer on one of the records of this package, which live as long as the program."""
        if self._member is not member:
            self._member, self._known = member, {}
        if id(window) not in self._known:
            self._known[id(window)] = member.quantify(window)
        return self._known[id(window)]


_ANSWERS = _Answers()


@demand("quantifier", "must be picklable, since it runs in a worker")
def travels(member: Quantifier) -> None:
    """Send it to another process, in effect."""
    require(pickled(member) == member, "it is another after a journey through pickle")


@demand("quantifier", "must find a sticking valve with its S, and none in a free one")
def verdicts(member: Quantifier) -> None:
    """Show one of each."""
    stuck, free = sound(_ANSWERS.of(member, stuck_for(member)), STUCK), sound(_ANSWERS.of(member, FREE), FREE)
    require(stuck.decision == "stiction", f"on a sticking valve its decision is {stuck.decision!r}")
    require(free.decision == "no_stiction", f"on a free valve its decision is {free.decision!r}")
    names = {stuck.quantifier, free.quantifier}
    require(names == {member.name}, f"its answers are named {', '.join(sorted(names))}")
    if stuck.stiction is not None:
        require_close(stuck.stiction.s.value, 5.0, "S", atol=S_TOLERANCE * STUCK.op_span)


@demand("quantifier", "must give the same answer each time and leave its input as it was")
def repeatable(member: Quantifier) -> None:
    """Quantify twice."""
    before = STUCK.op.copy(), STUCK.pv.copy()
    first, second = _ANSWERS.of(member, STUCK), member.quantify(STUCK)
    require((before[0] == STUCK.op).all() and (before[1] == STUCK.pv).all(), "it changes its input")
    require(numbers(first) == numbers(second), f"first {numbers(first)}, then {numbers(second)}")


@demand("quantifier", "must give the same answer in other units and with offsets")
def units_and_offsets(member: Quantifier) -> None:
    """Scale and shift OP and PV."""
    stuck = stuck_for(member)
    found = _ANSWERS.of(member, stuck)
    for op_gain, op_level, pv_gain, pv_level in ((0.02, -1, 40, -5e3), (250, 0, 0.1, 7)):
        op, pv = op_gain * stuck.op + op_level, pv_gain * stuck.pv + pv_level
        other = member.quantify(replace(stuck, op=op, pv=pv))
        with where(f"OP times {op_gain:g}, PV times {pv_gain:g}"):
            require(other.decision == found.decision, f"its decision is {other.decision!r}")
            if found.stiction and other.stiction and found.process and other.process:
                s, gain = found.stiction.s.value, found.process.gain
                require_close(other.stiction.s.value / op_gain, s, "S", atol=0.01 * STUCK.op_span)
                require_close(other.process.gain * op_gain / pv_gain, gain, "the gain", rtol=0.03)
            require_close(other.free_run_percent, found.free_run_percent, "free_run_percent", atol=0.5)


@demand("quantifier", "must find the same valve where PV is upside down")
def reversed_pv(member: Quantifier) -> None:
    """Turn PV, and the action of the controller with it."""
    stuck = stuck_for(member)
    hints = replace(HINTS, acting="direct")
    found = member.quantify(replace(stuck, pv=200 - stuck.pv, hints=hints))
    before = _ANSWERS.of(member, stuck)
    require(found.decision == "stiction", f"its decision is {found.decision!r}")
    if found.process and before.process:
        require_close(found.process.gain, -before.process.gain, "the gain", rtol=0.03)


@demand("quantifier", "must keep to hints that do not fit, and answer all the same")
def hints_that_do_not_fit(member: Quantifier) -> None:
    """Give a wrong kind of process, delay or action."""
    for hints in (
        LoopHints(integrating=True),
        LoopHints(delay=1),
        LoopHints(delay=len(HALF) // 2, order=2),
        LoopHints(delay=len(HALF), order=1),
        LoopHints(acting="direct"),
    ):
        with where(str(hints)):
            found = sound(member.quantify(HALF.with_hints(hints)), HALF)
            if found.process is None:
                continue
            if hints.integrating:
                require(found.process.kind == "integrator", f"its process is {found.process.kind!r}")
            if hints.delay:
                require_close(found.process.delay, hints.delay * HALF.ts, "the delay", rtol=1e-6)
            if hints.acting:
                require(found.process.gain <= 0, f"its gain is {found.process.gain:g}")


@demand("quantifier", "must not find stiction in records that cannot show it")
def no_false_accusation(member: Quantifier) -> None:
    """Show gaps, constants, steps, ramps and noise."""
    for name, op, pv in without_stiction():
        window = LoopWindow("storm", 0.0, 1.0, op, pv)
        with where(name):
            found = sound(member.quantify(window), window)
            require(found.decision != "stiction", "it finds stiction")


@demand("quantifier", "must give a sound answer, or a failure in words, on odd records and huge numbers")
def any_odd_record(member: Quantifier) -> None:
    """Show coarse, short, torn, spiky and huge records."""
    _each_is_sound(member, odd_records())


@demand("quantifier", "must give a sound answer, or a failure in words, where no valve explains PV")
def no_valve_explains_it(member: Quantifier) -> None:
    """Show coarse PV, coarse OP and a spike of OP."""
    _each_is_sound(member, records_of_no_valve())


def _each_is_sound(member: Quantifier, records: Iterable[tuple[str, FloatArray, FloatArray]]) -> None:
    for name, op, pv in records:
        window = LoopWindow("odd", 0.0, 1.0, op, pv)
        with where(name):
            sound(member.quantify(window), window)


@demand("quantifier", "must keep its verdict where one sample in ten is lost")
def single_lost_samples(member: Quantifier) -> None:
    """Lose samples of both signals, of a sticking valve and of a free one."""
    for window, expected in ((stuck_for(member), "stiction"), (FREE, "no_stiction")):
        decision = member.quantify(with_gaps(window, 0.1)).decision
        require(decision == expected, f"its decision is {decision!r} instead of {expected!r}")


@demand("quantifier", "must answer on 20,000 samples")
def long_record(member: Quantifier) -> None:
    """Show a record of 333 periods."""
    window = loop(4.0, 1.0, 20_000)
    sound(member.quantify(window), window)


CHECKS = (
    travels,
    verdicts,
    repeatable,
    units_and_offsets,
    reversed_pv,
    hints_that_do_not_fit,
    no_false_accusation,
    any_odd_record,
    no_valve_explains_it,
    single_lost_samples,
    long_record,
)
"""All checks of a quantifier."""
