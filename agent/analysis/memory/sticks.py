"""The probability that a valve sticks, for each diagnosis: of its window, or of all that is remembered."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from agent.analysis.cause import undecided_cause
from agent.analysis.evidence.weighing import SURE
from agent.analysis.memory.outcome import OUTCOMES, outcome_of, outcome_of_odds, part_of
from agent.analysis.memory.weighing_windows import BASE_RATE, probability_of
from agent.analysis.results import Sticks

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agent.analysis.diagnosis import Diagnosis
    from agent.analysis.evidence.weighing import Weighed
    from agent.analysis.memory.valve_memory import ValveMemory

LIKELY = 0.5
"""Probability from which a valve without a firm verdict is suspected."""


def is_suspected(diagnosis: Diagnosis) -> bool:
    """Whether the valve sticks more probably than not, though the verdict is another."""
    sticks = diagnosis.sticks
    return diagnosis.verdict != "stiction" and sticks is not None and sticks.probability >= LIKELY


def with_sticks(diagnosis: Diagnosis, base_rate: float = BASE_RATE) -> Diagnosis:
    """Return the diagnosis with the probability from its window alone."""
    return replace(diagnosis, sticks=sticks_of([diagnosis], base_rate))


def with_memory(diagnosis: Diagnosis, memory: ValveMemory, base_rate: float = BASE_RATE) -> Diagnosis:
    """Return the diagnosis with the probability from all windows that are remembered, its own among them.

    Where its verdict is ``stiction``, and the former days make that improbable, it becomes ``undecided``.
    """
    found = replace(diagnosis, sticks=Sticks(memory.probability(base_rate), base_rate, memory.windows))
    return _waiting(found) if _is_contradicted(diagnosis, memory, base_rate) else found


def _is_contradicted(diagnosis: Diagnosis, memory: ValveMemory, base_rate: float) -> bool:
    """Whether the former days make it improbable that the valve sticks, though this window says so.

    The other windows of its day do not speak against it: what began today is in the newest ones.
    """
    outcome = outcome_of(diagnosis)
    if diagnosis.verdict != "stiction" or outcome is None:
        return False
    probability = memory.with_today(outcome).probability(base_rate)
    return probability < min(LIKELY, sticks_of([diagnosis], base_rate).probability)


def _waiting(diagnosis: Diagnosis) -> Diagnosis:
    """Return the diagnosis without its verdict, with all that was measured."""
    oscillation = diagnosis.oscillation
    causes = diagnosis.causes if oscillation is None else (undecided_cause(oscillation),)
    return replace(
        diagnosis,
        verdict="undecided",
        confidence=0.0,
        cause=causes[0].cause,
        causes=causes,
        stiction_class=None,
        benefit=None,
        contradicted=True,
    )


def sticks_of(diagnoses: Sequence[Diagnosis], base_rate: float = BASE_RATE) -> Sticks:
    """Return the probability from windows of one valve, no event twice.

    Args:
        diagnoses: Of each window alone.
        base_rate: Part of the valves of the plant that stick.
    """
    counts = dict.fromkeys(OUTCOMES, 0.0)
    for each in diagnoses:
        if (outcome := outcome_of(each)) is not None:
            counts[outcome] += part_of(each, outcome)
    found = tuple(counts.values())
    return Sticks(probability_of(found, base_rate), base_rate, sum(found))


def in_view_of(sticks: Sticks, together: Weighed) -> Sticks:
    """Return the probability from recordings of one valve such that it does not contradict their verdict.

    Where all as one record are firm, it is not farther from that than the probability from one such record.
    """
    alone = tuple(float(each == outcome_of_odds(together)) for each in OUTCOMES)
    one = probability_of(alone, sticks.base_rate)
    if together.probability >= SURE:
        return replace(sticks, probability=max(sticks.probability, one))
    if together.probability <= 1 - SURE:
        return replace(sticks, probability=min(sticks.probability, one))
    return sticks
