"""The probability that a valve sticks, for each diagnosis: of its window, or of all that is remembered."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from agent.analysis.memory.outcome import OUTCOMES, outcome_of
from agent.analysis.memory.weighing_windows import BASE_RATE, probability_of
from agent.analysis.results import Sticks

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agent.analysis.diagnosis import Diagnosis
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
    """Return the diagnosis with the probability from all windows that are remembered, its own among them."""
    return replace(diagnosis, sticks=Sticks(memory.probability(base_rate), base_rate, memory.windows))


def sticks_of(diagnoses: Sequence[Diagnosis], base_rate: float = BASE_RATE) -> Sticks:
    """Return the probability from windows of one valve, no event twice."""
    outcomes = [each for each in map(outcome_of, diagnoses) if each is not None]
    counts = tuple(float(outcomes.count(each)) for each in OUTCOMES)
    return Sticks(probability_of(counts, base_rate), base_rate, float(len(outcomes)))
