"""From a window to a diagnosis: the first look, the fit, the weighing of evidence, the causes."""

from __future__ import annotations

import time
from dataclasses import replace
from typing import TYPE_CHECKING

from agent.analysis.benefit.benefit import benefit
from agent.analysis.cause import cause_without_stiction, causes_with_stiction, undecided_cause
from agent.analysis.diagnosis import Diagnosis, RecordSummary
from agent.analysis.evidence.weighing import SURE, sound_as_far_as_shown, weigh
from agent.analysis.gates.rhythm import samples_per_period
from agent.analysis.indices import performance
from agent.analysis.innovations import innovations_say
from agent.analysis.memory.sticks import with_sticks
from agent.analysis.not_testable import not_testable
from agent.analysis.quantify import quantifier as quantifier_named
from agent.analysis.quantify.free_run import LEAST_S
from agent.analysis.record.least_step import resolution
from agent.analysis.results import MethodResult
from agent.analysis.seen import look, worth_a_fit
from agent.analysis.stiction_class import stiction_class

if TYPE_CHECKING:
    from agent.analysis.evidence.weighing import Weighed
    from agent.analysis.quantify import Quantifier
    from agent.analysis.record.recording import LoopWindow
    from agent.analysis.results import CauseShare, Oscillation, Quantification, Verdict
    from agent.analysis.seen import Seen

DEFAULT_QUANTIFIER = "free_run"
FOLLOWED = 5.0
"""Least fit of the sticking model in free run for a firm verdict of stiction, %: one that follows hardly
anything says nothing of the valve, whatever the other witnesses say."""


def diagnose(
    window: LoopWindow, seen: Seen | None = None, *, quantifier: Quantifier | None = None
) -> Diagnosis:
    """Say whether the valve sticks, by how much, and else why the loop oscillates.

    Never raises on the content of a window: what forbids a verdict is in ``faults`` and in the
    ``failure`` of the quantification.

    Args:
        window: The stretch to judge.
        seen: The first look at the window; None takes it here.
        quantifier: The method that measures stiction; None takes the default one.
    """
    started = time.perf_counter()
    before = 0.0 if seen is None else seen.seconds
    seen = look(window) if seen is None else seen
    if not seen.testable:
        return with_sticks(not_testable(window, seen))
    diagnosis = _judge(window, seen, quantifier or quantifier_named(DEFAULT_QUANTIFIER))
    found = diagnosis.quantification
    delay = None if found is None or found.process is None else found.process.delay
    indices = performance(window, delay)
    if diagnosis.verdict == "stiction" and found is not None:
        diagnosis = replace(diagnosis, benefit=benefit(window, found))
    diagnosis = replace(diagnosis, indices=indices, seconds=before + time.perf_counter() - started)
    return with_sticks(diagnosis)


def _judge(window: LoopWindow, seen: Seen, quantifier: Quantifier) -> Diagnosis:
    found = with_innovations(quantifier.quantify(window), window)
    samples = samples_per_period(window, seen.oscillation)
    stem_measured = window.mv is not None
    weighed = weigh(found, seen.methods, stem_measured=stem_measured, samples_per_period=samples)
    without_verdict = Diagnosis(
        loop=window.loop,
        verdict="undecided",
        confidence=0.0,
        cause="undecided",
        causes=(),
        stiction_class=None,
        oscillation=seen.oscillation,
        quantification=found,
        methods={
            found.quantifier: MethodResult(found.decision, found.evidence, found.failure or ""),
            **seen.methods,
        },
        faults=seen.faults,
        weighed=weighed,
        record=RecordSummary.of(window, seen.oscillation),
        quiet=not worth_a_fit(seen),
        no_response=seen.no_response,
        as_before=seen.as_before,
    )
    return with_verdict(without_verdict, window, *verdict_of(found, weighed))


def with_verdict(diagnosis: Diagnosis, window: LoopWindow, verdict: Verdict, confidence: float) -> Diagnosis:
    """Return a diagnosis with another verdict, and with the causes and the class of that.

    Where PV does not respond, ``no_stiction`` becomes ``undecided``: the valve may be stuck. And ``stiction``
    becomes ``undecided`` where S is less than the best positioners resolve: that is no fault of a valve, and
    a load that the models lack makes as much.

    Args:
        diagnosis: Of a record that was testable; another is returned as it is.
        window: The record.
        verdict: On the valve.
        confidence: Probability that it is right.
    """
    found, oscillation = diagnosis.quantification, diagnosis.oscillation
    if found is None or oscillation is None:
        return diagnosis
    if verdict == "no_stiction" and diagnosis.no_response is not None:
        verdict, confidence = "undecided", 0.0
    if verdict == "stiction" and found.stiction is not None and found.stiction.s.value < resolution(window):
        verdict, confidence = "undecided", 0.0
    if verdict == "stiction":
        found = as_decided(found, window.op_span)
    causes = _causes(verdict, window, oscillation, found)
    sticking = found.stiction if verdict == "stiction" else None
    return replace(
        diagnosis,
        verdict=verdict,
        confidence=confidence,
        quantification=found,
        cause=causes[0].cause,
        causes=causes,
        stiction_class=None if sticking is None else stiction_class(sticking.bands, window.op_span),
    )


def as_decided(found: Quantification, op_span: float) -> Quantification:
    """Return the fit of a valve that other witnesses say sticks: the model that does, and S if it shows any.

    An S that no record can show, below ``LEAST_S`` of the span, is not how much the valve sticks.
    """
    if found.sticking is not None:
        model = found.sticking
        found = replace(found, process=model.process, model_pv=model.pv, model_mv=model.mv, sticking=None)
    if found.stiction is not None and found.stiction.s.value < LEAST_S * op_span:
        found = replace(found, stiction=None)
    return found


def with_innovations(found: Quantification, window: LoopWindow) -> Quantification:
    """Return the answer of ``free_run`` with what the innovations say; another or a complete one as it is.

    The valve with the least error goes no further: nobody else needs its curve.
    """
    known = found.log_likelihood_ratio is not None
    if known or found.failure is not None or found.quick_evidence is None:
        return found
    say = innovations_say(window, found)
    return replace(
        found,
        log_likelihood_ratio=say.log_likelihood_ratio,
        would_show=say.would_show,
        load_wave=say.wave,
        slip_scatter=say.slip_scatter,
        least_error=None,
    )


def verdict_of(found: Quantification, weighed: Weighed) -> tuple[Verdict, float]:
    """Return the verdict and the probability that it is right.

    Only ``free_run`` is weighed with the detectors: the weights were fitted with it. Another quantifier
    decides alone, and no probability is known: 0.5 stands for it.
    """
    if found.failure is not None or found.decision == "not_applicable":
        return "undecided", 0.0
    if found.quick_evidence is None:
        sure = found.decision == "no_stiction" or (
            found.decision == "stiction" and found.stiction is not None
        )
        return (found.decision, 0.5) if sure else ("undecided", 0.0)
    follows = found.free_run_percent is None or found.free_run_percent >= FOLLOWED
    if weighed.probability >= SURE and found.stiction is not None and follows:
        return "stiction", weighed.probability
    if weighed.probability <= 1 - SURE and found.decision == "no_stiction":
        return "no_stiction", sound_as_far_as_shown(weighed.probability, weighed.would_show)
    return "undecided", 0.0


def _causes(
    verdict: Verdict, window: LoopWindow, oscillation: Oscillation, found: Quantification
) -> tuple[CauseShare, ...]:
    if verdict == "stiction":
        return causes_with_stiction(window, found)
    if verdict == "no_stiction":
        return cause_without_stiction(window, oscillation, found)
    return (undecided_cause(oscillation),)
