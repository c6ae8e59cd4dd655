"""The probability that a valve sticks, for each diagnosis: of its window, or of all that is remembered."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from agent.analysis.memory.outcome import OUTCOMES, outcome_of, outcome_of_odds
from agent.analysis.memory.weighing_windows import BASE_RATE, probability_of
from agent.analysis.results import Sticks

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agent.analysis.diagnosis import Diagnosis
    from agent.analysis.evidence.weighing import Weighed
    from agent.analysis.memory.outcome import Outcome
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
    """Return the probability from windows of one valve, no event twice, each as one outcome."""
    outcomes = _outcomes(diagnoses)
    return _sticks(outcomes, base_rate, len(outcomes))


def sticks_together(
    together: Weighed, diagnoses: Sequence[Diagnosis], base_rate: float = BASE_RATE
) -> Sticks:
    """Return the probability from recordings of one valve, from the same number as their verdict.

    Weighed as one long record they have the outcome of one; a valve that was stuck counts besides. Outcomes
    of each would not do: where nothing happens a record of any valve speaks against stiction, and several of
    them would add up against the slips of the others.

    Args:
        together: All of them as one record.
        diagnoses: Of each alone, no event twice.
        base_rate: Part of the valves of the plant that stick.
    """
    outcomes = _outcomes(diagnoses)
    stuck = [each for each in outcomes if each == "stuck"]
    return _sticks([outcome_of_odds(together), *stuck], base_rate, len(outcomes))


def _outcomes(diagnoses: Sequence[Diagnosis]) -> list[Outcome]:
    return [each for each in map(outcome_of, diagnoses) if each is not None]


def _sticks(outcomes: Sequence[Outcome], base_rate: float, windows: int) -> Sticks:
    counts = tuple(float(outcomes.count(each)) for each in OUTCOMES)
    return Sticks(probability_of(counts, base_rate), base_rate, float(windows))
