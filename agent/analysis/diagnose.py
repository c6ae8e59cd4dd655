"""From evidence to a diagnosis, with reasons an engineer can check."""

from __future__ import annotations

import time
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.advice import advice
from agent.analysis.cause import cause_without_stiction, causes_with_stiction
from agent.analysis.evidence.weighing import weigh
from agent.analysis.gates import ALL_KINDS, closed_kinds, gates
from agent.analysis.innovations import log_likelihood_ratio
from agent.analysis.oscillation import detect_oscillation
from agent.analysis.quantify import Quantifier
from agent.analysis.quantify import quantifier as quantifier_named
from agent.analysis.reasons import bands_of, reasons
from agent.analysis.record.recording import FloatArray, LoopWindow
from agent.analysis.results import (
    CauseShare,
    Diagnosis,
    MethodResult,
    Oscillation,
    Quantification,
    Verdict,
)
from agent.analysis.stiction import detect_stiction
from agent.analysis.stiction_class import stiction_class

if TYPE_CHECKING:
    from agent.analysis.evidence.weighing import Weighed
    from agent.analysis.gates import GateFault

LARGEST = 1e15
"""No plant has such numbers: historians mark lost values by 1e30 and the like."""
DEFAULT_QUANTIFIER = "free_run"
SURE = 0.8
"""Probability from which the valve is blamed, or cleared: one of 187 simulated sound loops exceeds it, each
weighed by what the others taught."""


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
    open_yet = Diagnosis(
        loop=window.loop,
        verdict="undecided",
        confidence=0.0,
        cause="undecided",
        causes=(),
        stiction_class=None,
        reasons=(),
        oscillation=oscillation,
        quantification=found,
        methods={
            found.quantifier: MethodResult(found.decision, found.evidence, found.failure or ""),
            **detected,
        },
        gates=tuple(fault.name for fault in faults),
    )
    return _concluded(open_yet, window, faults, weighed, *verdict_of(found, weighed))


def with_verdict(diagnosis: Diagnosis, window: LoopWindow, verdict: Verdict, confidence: float) -> Diagnosis:
    """Return a diagnosis with another verdict, and with the cause, class, reasons and advice of that.

    Args:
        diagnosis: Of a record that was testable; another is returned as it is.
        window: The record.
        verdict: On the valve.
        confidence: Probability that it is right.
    """
    if diagnosis.oscillation is None or diagnosis.quantification is None:
        return diagnosis
    weighed = weigh(diagnosis.quantification, diagnosis.methods, stem_measured=window.mv is not None)
    faults = gates(window, diagnosis.oscillation)
    return _concluded(diagnosis, window, faults, weighed, verdict, confidence)


def _concluded(
    diagnosis: Diagnosis,
    window: LoopWindow,
    faults: tuple[GateFault, ...],
    weighed: Weighed,
    verdict: Verdict,
    confidence: float,
) -> Diagnosis:
    """Return the diagnosis with all that follows from the verdict."""
    found, oscillation = diagnosis.quantification, diagnosis.oscillation
    if found is None or oscillation is None:
        return diagnosis
    causes = _causes(verdict, window, oscillation, found)
    sticking = found.stiction if verdict == "stiction" else None
    return replace(
        diagnosis,
        verdict=verdict,
        confidence=confidence,
        cause=causes[0].cause,
        causes=causes,
        stiction_class=None if sticking is None else stiction_class(bands_of(sticking), window.op_span),
        reasons=reasons(window, oscillation, faults, found, weighed, verdict),
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
