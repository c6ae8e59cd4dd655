"""What the contract of a stiction detector demands: ``agent.analysis.stiction.StictionDetector``."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, get_args

import numpy as np

from agent.analysis.record.recording import LoopHints, LoopWindow
from agent.analysis.results import MethodKind, Oscillation
from agent.checks.contract import demand, require, where
from agent.checks.detector_records import (
    NO_OSCILLATION,
    NO_VERDICT,
    SIGNALS,
    changed,
    detected,
    loops,
    pickled,
    random_window,
    require_same,
    signals_of,
    simulated,
    swinging,
)

if TYPE_CHECKING:
    from agent.analysis.stiction import StictionDetector

RECORDS = 30
"""Of random records of any size."""


@demand("stiction detector", "must have a known kind and must be picklable, like its answer")
def travels(member: StictionDetector) -> None:
    """Send it to another process, in effect."""
    require(str(member.name).isidentifier(), f"its name is {member.name!r}")
    require(member.kind in get_args(MethodKind), f"its kind is {member.kind!r}")
    require(pickled(member) == member, "it is another after a journey through pickle")
    result = member.detect(*simulated("stiction"))
    require(pickled(result) == result, "its answer is another after a journey through pickle")


@demand("stiction detector", "must give the same answer each time and leave its input as it was")
def repeatable(member: StictionDetector) -> None:
    """Detect twice."""
    for window, oscillation in loops():
        before = [values.copy() for values in signals_of(window).values()]
        one = member.detect(window, oscillation)
        with where(window.loop):
            require_same(one, member.detect(window, oscillation))
            same = [(a == b).all() for a, b in zip(before, signals_of(window).values(), strict=True)]
            require(all(same), "it changes its input")


@demand("stiction detector", "must give the same answer in other units and with offsets")
def units_and_offsets(member: StictionDetector) -> None:
    """Scale and shift OP, and PV with its set point; with the stem measured and not."""
    for window, oscillation in loops(without_mv=True):
        one = member.detect(window, oscillation)
        for of_op, of_pv in ((60.0, 0.07), (1e-9, 1e9), (1e9, 1e-9)):
            found = {"op": of_op * (window.op - 500.0), "pv": of_pv * (window.pv + 300.0)}
            if window.sp is not None:
                found["sp"] = of_pv * (window.sp + 300.0)
            if window.mv is not None:
                found["mv"] = of_pv * (window.mv - 70.0)
            with where(f"{window.loop}, OP times {of_op:g}, PV times {of_pv:g}"):
                require_same(one, member.detect(changed(window, **found), oscillation))


@demand("stiction detector", "must give the same answer where PV is upside down")
def reversed_pv(member: StictionDetector) -> None:
    """Turn PV and the set point; with the stem measured and not."""
    for window, oscillation in loops(without_mv=True):
        found = {"pv": -window.pv} | ({} if window.sp is None else {"sp": -window.sp})
        with where(window.loop):
            require_same(
                member.detect(window, oscillation), member.detect(changed(window, **found), oscillation)
            )


@demand("stiction detector", "must give the same answer where all is slower")
def slower_time(member: StictionDetector) -> None:
    """Sample once a minute, at another time."""
    for window, oscillation in loops():
        slow = replace(window, ts=60.0, start=1e9)
        period = None if oscillation.period is None else 60.0 * oscillation.period
        with where(window.loop):
            other = member.detect(slow, replace(oscillation, period=period))
            require_same(member.detect(window, oscillation), other)


@demand("stiction detector", "must treat gaps at the ends as not recorded")
def gaps_at_the_ends(member: StictionDetector) -> None:
    """Put 200 gaps at each end, or lose OP in the second half."""
    gaps = np.full(200, np.nan)
    for window, oscillation in loops():
        signals = signals_of(window)
        longer = changed(window, **{name: np.r_[gaps, values, gaps] for name, values in signals.items()})
        with where(f"{window.loop}, gaps at both ends"):
            require_same(member.detect(window, oscillation), member.detect(longer, oscillation))
        half = len(window) // 2
        rest = changed(window, op=np.where(np.arange(len(window)) < half, window.op, np.nan))
        first = changed(window, **{name: values[:half] for name, values in signals.items()})
        with where(f"{window.loop}, the second half missing"):
            require_same(member.detect(first, oscillation), member.detect(rest, oscillation))


@demand("stiction detector", "must give no verdict where two of five samples are missing")
def storm_of_gaps(member: StictionDetector) -> None:
    """Lose OP and PV apart from each other."""
    for window, oscillation in loops():
        lost = np.random.default_rng(0).random((2, len(window))) < 0.4
        stormy = changed(
            window, op=np.where(lost[0], np.nan, window.op), pv=np.where(lost[1], np.nan, window.pv)
        )
        verdict = detected(member, stormy, oscillation).verdict
        require(verdict in NO_VERDICT, f"{window.loop}: its verdict is {verdict!r}")


@demand("stiction detector", "must answer not_applicable where OP or PV is missing altogether")
def nothing_recorded(member: StictionDetector) -> None:
    """Lose one of the two."""
    window, oscillation = simulated("stiction")
    for name in ("op", "pv"):
        lost = changed(window, **{name: np.full(len(window), np.nan)})
        verdict = detected(member, lost, oscillation).verdict
        require(verdict == "not_applicable", f"no {name.upper()}: its verdict is {verdict!r}")


@demand("stiction detector", "must not find stiction in signals that stand still")
def still_signals(member: StictionDetector) -> None:
    """Hold OP, PV or both at levels of any size."""
    window, oscillation = simulated("stiction")
    for level in (0.0, 50.0, 1e14, 1e-14):
        for still in (("op", "mv"), ("pv", "sp", "mv"), SIGNALS):
            held = changed(window, **dict.fromkeys(still, np.full(len(window), level)))
            verdict = detected(member, held, oscillation).verdict
            require(verdict != "stiction", f"{', '.join(still)} at {level:g}: it finds stiction")


@demand("stiction detector", "must give no verdict on 20 samples and fewer")
def few_samples(member: StictionDetector) -> None:
    """Cut the record; the period fits it or not."""
    window, _ = simulated("stiction")
    for samples in (0, 1, 2, 3, 5, 10, 20):
        few = changed(window, **{name: values[:samples] for name, values in signals_of(window).items()})
        for oscillation in (NO_OSCILLATION, swinging(0.5), swinging(4.0), swinging(1e6)):
            verdict = detected(member, few, oscillation).verdict
            period = f"{samples} samples, period {oscillation.period}"
            require(verdict in NO_VERDICT, f"{period}: its verdict is {verdict!r}")


@demand("stiction detector", "must answer without an oscillation, and give no verdict if it needs one")
def no_oscillation(member: StictionDetector) -> None:
    """Say that there is none."""
    for window, _ in loops():
        verdict = detected(member, window, NO_OSCILLATION).verdict
        with where(window.loop):
            quiet = member.kind != "limit_cycle" or verdict in NO_VERDICT
            require(quiet, f"its kind is limit_cycle and its verdict {verdict!r}")


@demand("stiction detector", "must answer whatever is known of the process")
def any_hint(member: StictionDetector) -> None:
    """Say that the process integrates, or not, or leave it open."""
    for window, oscillation in loops():
        for integrating in (True, False, None):
            hinted = window.with_hints(LoopHints(integrating=integrating))
            with where(f"{window.loop}, integrating {integrating}"):
                detected(member, hinted, oscillation)


@demand("stiction detector", "must answer on any record, with a finite index and a reason")
def any_record(member: StictionDetector) -> None:
    """Draw noise and walks, coarse, with gaps, of any size."""
    rng = np.random.default_rng(7)
    for _ in range(RECORDS):
        case, window, oscillation = random_window(rng)
        with where(case):
            detected(member, window, oscillation)


@demand("stiction detector", "must answer on 20,000 samples")
def long_record(member: StictionDetector) -> None:
    """Show a noisy wave with many periods and with few."""
    rng = np.random.default_rng(1)
    for period in (10.0, 60.0, 3000.0):
        phase = 2 * np.pi * np.arange(20_000) / period
        op, pv = np.sin(phase) + 0.1 * rng.normal(size=(2, 20_000))
        with where(f"a period of {period:g} samples"):
            detected(member, LoopWindow("long", 0.0, 1.0, op, pv), Oscillation(True, period, 3.0))


CHECKS = (
    travels,
    repeatable,
    units_and_offsets,
    reversed_pv,
    slower_time,
    gaps_at_the_ends,
    storm_of_gaps,
    nothing_recorded,
    still_signals,
    few_samples,
    no_oscillation,
    any_hint,
    any_record,
    long_record,
)
"""All checks of a stiction detector."""
