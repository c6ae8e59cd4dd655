"""What a record shows, and what speaks for and against a sticking valve, in plain words."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from agent.analysis.gates.fault import LIMIT_CYCLE, SHAPE
from agent.analysis.stiction_class import stiction_class
from agent.units import FrictionBands

if TYPE_CHECKING:
    from collections.abc import Iterable

    from agent.analysis.evidence.weighing import Weighed
    from agent.analysis.gates import GateFault
    from agent.analysis.record.recording import LoopWindow
    from agent.analysis.results import (
        MethodKind,
        Oscillation,
        Quantification,
        StictionClass,
        StictionEstimate,
        Verdict,
    )

COARSE = 15.0
"""Samples a period below which the shape of a stroke is hardly seen; the paper asks for 50."""

NOT_ASKED: dict[frozenset[MethodKind], str] = {
    LIMIT_CYCLE: "what needs a steady oscillation was not asked",
    SHAPE: "what looks at the shape of OP and PV was not asked",
}
CLASS_WORDS: dict[StictionClass, str] = {
    "weak": "weak stiction",
    "dead_band": "mostly a dead band",
    "stick_slip": "stick and slip",
    "dead_band_stick_slip": "a dead band with stick and slip",
}


def reasons(
    window: LoopWindow,
    oscillation: Oscillation,
    faults: Iterable[GateFault],
    found: Quantification,
    weighed: Weighed,
    verdict: Verdict,
) -> tuple[str, ...]:
    """Return all there is to say of a record that was testable.

    Args:
        window: The record.
        oscillation: What was seen in it.
        faults: What stood in the way of some methods.
        found: What the quantifier found.
        weighed: What all witnesses say together.
        verdict: On the valve.
    """
    return (
        *_data_words(window),
        *_oscillation_words(window, oscillation),
        *_fit_words(window, found, verdict),
        *_witness_words(found, weighed),
        *_gate_words(faults),
    )


def bands_of(stiction: StictionEstimate) -> FrictionBands:
    """Return the friction of an estimate without its intervals, OP units."""
    return FrictionBands(stiction.f_s.value, stiction.f_d.value)


def _data_words(window: LoopWindow) -> list[str]:
    words = []
    lost = int((~window.valid).sum())
    if lost:
        words.append(f"{lost} of {len(window)} samples are gaps and were left out")
    if window.duplicates:
        words.append(f"{window.duplicates} samples repeat a timestamp and were dropped")
    return words


def _oscillation_words(window: LoopWindow, oscillation: Oscillation) -> list[str]:
    if not oscillation.detected or oscillation.period is None:
        return ["the loop shows no regular oscillation"]
    words = [f"the loop oscillates with a period of {oscillation.period:.4g} s"]
    samples = oscillation.period / window.ts
    if samples < COARSE:
        words.append(f"with {samples:.0f} samples a period the record is coarse")
    return words


def _fit_words(window: LoopWindow, found: Quantification, verdict: Verdict) -> list[str]:
    if found.failure is not None:
        return [f"{found.quantifier} gave no answer: {found.failure}"]
    linear = f"the process alone follows PV to {_percent(found.linear_percent)}"
    if found.stiction is None:
        return [f"{linear}, and a sticking valve does not explain more"]
    s, j = found.stiction.s.value, found.stiction.j.value
    span = f"{100 * s / window.op_span:.3g} % of the span of OP"
    valve = f"with a valve of S = {s:.4g} ({span}) and J = {j:.4g}"
    words = [f"{linear}, {valve} to {_percent(found.free_run_percent)}"]
    if verdict == "stiction":
        words.append(
            f"the valve shows {CLASS_WORDS[stiction_class(bands_of(found.stiction), window.op_span)]}"
        )
    elif verdict == "no_stiction":
        words.append("that is too little better to blame the valve")
    else:
        words.append("that is not enough to blame the valve, nor to clear it")
    return words


def _witness_words(found: Quantification, weighed: Weighed) -> list[str]:
    """Say who speaks for a sticking valve and who against, by what factor each moves the odds."""
    if found.failure is not None or found.quick_evidence is None:
        return []
    sides = (
        ("for a sticking valve", [each for each in weighed.witnesses if each.log_odds > 0]),
        ("against it", [each for each in weighed.witnesses if each.log_odds < 0]),
    )
    return [
        f"{side}: " + ", ".join(f"{each.name} (odds x {factor(each.log_odds)})" for each in ones)
        for side, ones in sides
        if ones
    ]


def factor(log_odds: float) -> str:
    """Say by what factor log odds move the odds, whichever way."""
    times = math.exp(abs(log_odds))
    return f"{times:,.0f}" if times >= 10 else f"{times:.1f}"


def _gate_words(faults: Iterable[GateFault]) -> list[str]:
    return [f"{fault.reason}: {NOT_ASKED[fault.closes]}" for fault in faults]


def _percent(value: float | None) -> str:
    return "an unknown part" if value is None else f"{value:.3g} %"
