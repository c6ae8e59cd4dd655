"""A diagnosis in plain words: the lines of ``slipjump diagnose``."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

from agent.report.advice import advice
from agent.report.numbers import interval_words
from agent.report.parts.benefit_words import benefit_lines
from agent.report.reasons import reasons

if TYPE_CHECKING:
    from agent.analysis.diagnosis import Diagnosis
    from agent.analysis.results import (
        IntervalEstimate,
        MethodResult,
        ProcessEstimate,
        Sticks,
        StictionEstimate,
    )


SIDES = {
    "stiction": "methods for stiction",
    "no_stiction": "methods against stiction",
    "undecided": "methods that are undecided",
}
"""Verdicts of methods -> the words before their names and indices."""
ANSWER = 0.5
"""Width of an interval, over the value, up to which it is an answer: neither repair nor bump test depends on
a quarter more or less."""


def diagnosis_lines(diagnosis: Diagnosis) -> Iterator[str]:
    """Yield the verdict, what to do next, why, the numbers with their 90 % intervals, and the methods."""
    verdict = diagnosis.verdict.replace("_", " ")
    confidence = f" (confidence {diagnosis.confidence:.2f})" if diagnosis.confidence else ""
    cause = diagnosis.cause.replace("_", " ")
    because = "" if diagnosis.cause in ("stiction", "undecided") else f", {cause}"
    yield f"{diagnosis.loop}: {verdict}{confidence}{because}"
    yield from (f"  > {step}" for step in advice(diagnosis))
    yield from (f"  - {reason}" for reason in reasons(diagnosis))
    if diagnosis.sticks is not None and diagnosis.sticks.windows:
        alone = "; the confidence is of this record alone, at 0.5" if diagnosis.confidence else ""
        yield f"  {sticks_words(diagnosis.sticks)}{alone}"
    found = diagnosis.quantification
    if found is not None and diagnosis.verdict in ("stiction", "undecided"):
        numbers = [] if found.stiction is None else _stiction(found.stiction)
        numbers += [] if found.process is None else _process(found.process)
        yield from (f"  {line}" for line in numbers)
    if diagnosis.benefit is not None:
        yield from (f"  {line}" for line in benefit_lines(diagnosis.benefit))
    yield from (f"  {line}" for line in method_lines(diagnosis.methods))


def sticks_words(sticks: Sticks) -> str:
    """Return the probability that the valve sticks, and where it comes from."""
    count = round(sticks.windows, 1)
    windows = "1 window" if count == 1 else f"{count:g} windows"
    return f"P(sticks) = {sticks.probability:.2f}, from {windows} at a base rate of {sticks.base_rate:.2g}"


def method_lines(methods: Mapping[str, MethodResult]) -> Iterator[str]:
    """Yield a line for each verdict, with the methods that gave it and their index; count the others."""
    for verdict, words in SIDES.items():
        said = [_indexed(name, each.index) for name, each in methods.items() if each.verdict == verdict]
        if said:
            yield f"{words}: {', '.join(said)}"
    silent = sum(each.verdict == "not_applicable" for each in methods.values())
    if silent:
        yield f"methods that do not apply: {silent} (--json states why)"


def _indexed(name: str, index: float | None) -> str:
    return name if index is None else f"{name} {index:.3g}"


def _stiction(stiction: StictionEstimate) -> list[str]:
    lines = [
        estimate_line("S", stiction.s, identifiable=stiction.identifiable_s),
        estimate_line("J", stiction.j, identifiable=stiction.identifiable_j),
        estimate_line("f_S", stiction.f_s),
        estimate_line("f_D", stiction.f_d),
    ]
    return [line for line in lines if line is not None]


def estimate_line(name: str, estimate: IntervalEstimate, *, identifiable: bool | None = None) -> str | None:
    """Return a line for a number in OP units; None where nothing is known of how sure it is."""
    span = interval_words(estimate)
    if identifiable is False and span and answers(estimate):
        return f"{name} = {estimate.value:.4g} OP units, uncertain: {span}"
    if identifiable is False:
        allowed = f"the record allows {span}" if span else "the record does not determine it"
        return f"{name} = {estimate.value:.4g} OP units, but not identifiable: {allowed}"
    return f"{name} = {estimate.value:.4g} OP units, 90 % interval {span}" if span else None


def answers(estimate: IntervalEstimate) -> bool:
    """Whether an interval is narrow enough to be an answer, though it does not identify the value."""
    if estimate.low is None or estimate.high is None:
        return False
    return estimate.high - estimate.low <= ANSWER * abs(estimate.value)


def _process(process: ProcessEstimate) -> list[str]:
    intervals = process.intervals
    if intervals is None:
        return []
    unit = "PV units per OP unit and s" if process.kind == "integrator" else "PV units per OP unit"
    rows = [
        ("gain", process.gain, intervals.gain, unit),
        ("time constant", process.tau, intervals.tau, "s"),
        ("second time constant", process.tau2, intervals.tau2, "s"),
        ("delay", process.delay, intervals.delay, "s"),
    ]
    return [
        f"{name} = {value:.4g} {unit}, 90 % interval {ends[0]:.4g} to {ends[1]:.4g}"
        for name, value, ends, unit in rows
        if value is not None and ends is not None
    ]
