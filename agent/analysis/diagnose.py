"""From evidence to a diagnosis, with reasons an engineer can check."""

from __future__ import annotations

import math
import time
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.advice import advice
from agent.analysis.cause import cause_without_stiction, causes_with_stiction
from agent.analysis.evidence import weigh
from agent.analysis.gates import ALL_KINDS, closed_kinds, gates
from agent.analysis.gates.fault import LIMIT_CYCLE, SHAPE
from agent.analysis.innovations import log_likelihood_ratio
from agent.analysis.oscillation import detect_oscillation
from agent.analysis.quantify import Quantifier
from agent.analysis.quantify import quantifier as quantifier_named
from agent.analysis.recording import FloatArray, LoopWindow
from agent.analysis.results import (
    CauseShare,
    Diagnosis,
    MethodResult,
    Oscillation,
    Quantification,
    StictionEstimate,
    Verdict,
)
from agent.analysis.stiction import detect_stiction
from agent.analysis.stiction_class import stiction_class
from agent.units import FrictionBands

if TYPE_CHECKING:
    from collections.abc import Iterable

    from agent.analysis.evidence import Weighed
    from agent.analysis.gates import GateFault
    from agent.analysis.results import MethodKind, StictionClass

LARGEST = 1e15
"""No plant has such numbers: historians mark lost values by 1e30 and the like."""
DEFAULT_QUANTIFIER = "free_run"
SURE = 0.8
"""Probability from which the valve is blamed, or cleared: one of 187 simulated sound loops exceeds it, each
weighed by what the others taught."""
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


def diagnose(window: LoopWindow, *, quantifier: Quantifier | None = None) -> Diagnosis:
    """Say whether the valve sticks, by how much, and else why the loop swings.

    Never raises on the content of a window: what forbids a verdict is told in ``reasons``.

    Args:
        window: The stretch to judge.
        quantifier: The method that measures stiction; None takes the default one.
    """
    started = time.perf_counter()
    diagnosis = _judge(without_impossible(window), quantifier or quantifier_named(DEFAULT_QUANTIFIER))
    return replace(diagnosis, seconds=time.perf_counter() - started)


def without_impossible(window: LoopWindow) -> LoopWindow:
    """Return the window with gaps where its numbers are too large for any plant."""
    return replace(
        window,
        op=_possible(window.op),
        pv=_possible(window.pv),
        sp=None if window.sp is None else _possible(window.sp),
        mv=None if window.mv is None else _possible(window.mv),
    )


def _possible(values: FloatArray) -> FloatArray:
    return np.where(np.abs(values) < LARGEST, values, np.nan)


def _judge(window: LoopWindow, quantifier: Quantifier) -> Diagnosis:
    oscillation = detect_oscillation(window)
    faults = gates(window, oscillation)
    if closed_kinds(faults) == ALL_KINDS:
        return Diagnosis(
            loop=window.loop,
            verdict="not_testable",
            confidence=0.0,
            cause="undecided",
            causes=(CauseShare("undecided", 1.0),),
            stiction_class=None,
            reasons=tuple(fault.reason for fault in faults),
            oscillation=None,
            quantification=None,
            gates=tuple(fault.name for fault in faults),
            advice=advice("not_testable", (), None, oscillation, window),
        )
    found = with_likelihood(quantifier.quantify(window), window)
    detected = detect_stiction(window, oscillation, faults)
    weighed = weigh(found, detected, stem_measured=window.mv is not None)
    verdict, confidence = verdict_of(found, weighed)
    causes = _causes(verdict, window, oscillation, found)
    sticking = found.stiction if verdict == "stiction" else None
    return Diagnosis(
        loop=window.loop,
        verdict=verdict,
        confidence=confidence,
        cause=causes[0].cause,
        causes=causes,
        stiction_class=None if sticking is None else stiction_class(_bands(sticking), window.op_span),
        reasons=(
            *_data_words(window),
            *_oscillation_words(window, oscillation),
            *_fit_words(window, found, verdict),
            *_witness_words(found, weighed),
            *_gate_words(faults),
        ),
        oscillation=oscillation,
        quantification=found,
        methods={
            found.quantifier: MethodResult(found.decision, found.evidence, found.failure or ""),
            **detected,
        },
        gates=tuple(fault.name for fault in faults),
        advice=advice(verdict, [each.cause for each in causes], found.stiction, oscillation, window),
    )


def with_likelihood(found: Quantification, window: LoopWindow) -> Quantification:
    """Return the answer of ``free_run`` with its log likelihood ratio unless it has one; another as it is."""
    told = found.log_likelihood_ratio is not None
    if told or found.failure is not None or found.quick_evidence is None:
        return found
    return replace(found, log_likelihood_ratio=log_likelihood_ratio(window, found))


def verdict_of(found: Quantification, weighed: Weighed) -> tuple[Verdict, float]:
    """Return the verdict and how probable it is that it is right.

    Only ``free_run`` is weighed with the detectors: the weights were fitted with it. Another quantifier has
    the word alone, and no probability is known: 0.5 stands for it.
    """
    if found.failure is not None or found.decision == "not_applicable":
        return "undecided", 0.0
    if found.quick_evidence is None:
        sure = found.decision == "no_stiction" or (
            found.decision == "stiction" and found.stiction is not None
        )
        return (found.decision, 0.5) if sure else ("undecided", 0.0)
    if weighed.probability >= SURE and found.stiction is not None:
        return "stiction", weighed.probability
    if weighed.probability <= 1 - SURE and found.decision == "no_stiction":
        return "no_stiction", 1 - weighed.probability
    return "undecided", 0.0


def _causes(
    verdict: Verdict, window: LoopWindow, oscillation: Oscillation, found: Quantification
) -> tuple[CauseShare, ...]:
    if verdict == "stiction":
        return causes_with_stiction(window, found)
    if verdict == "no_stiction":
        return cause_without_stiction(window, oscillation, found)
    # What the loop does is known, also where it is not known what the valve does.
    return (CauseShare("undecided" if oscillation.detected else "no_oscillation", 1.0),)


def _bands(stiction: StictionEstimate) -> FrictionBands:
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
        words.append(f"the valve shows {CLASS_WORDS[stiction_class(_bands(found.stiction), window.op_span)]}")
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
        f"{side}: " + ", ".join(f"{each.name} (odds x {_factor(each.log_odds)})" for each in ones)
        for side, ones in sides
        if ones
    ]


def _factor(log_odds: float) -> str:
    factor = math.exp(abs(log_odds))
    return f"{factor:,.0f}" if factor >= 10 else f"{factor:.1f}"


def _gate_words(faults: Iterable[GateFault]) -> list[str]:
    return [f"{fault.reason}: {NOT_ASKED[fault.closes]}" for fault in faults]


def _percent(value: float | None) -> str:
    return "an unknown part" if value is None else f"{value:.3g} %"
