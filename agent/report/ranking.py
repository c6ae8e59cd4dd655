"""What to do next: the group of a diagnosis, and the groups in the order of their urgency."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Literal

from agent.analysis.memory.sticks import is_suspected

if TYPE_CHECKING:
    from agent.analysis.diagnosis import Diagnosis
    from agent.analysis.results import IntervalEstimate

Group = Literal[
    "sticks", "suspected", "tight_tuning", "disturbance", "undecided", "not_testable", "healthy", "waiting"
]
GROUPS: Mapping[Group, str] = {
    "sticks": "Sticks",
    "suspected": "Suspected",
    "tight_tuning": "Tight tuning",
    "disturbance": "Disturbance",
    "undecided": "Undecided",
    "not_testable": "Not testable",
    "healthy": "No stiction",
    "waiting": "No verdict yet",
}
"""In the order of their urgency, with their words."""
ORDER = {group: place for place, group in enumerate(GROUPS)}


def group_of(diagnosis: Diagnosis | None) -> Group:
    """Return the group of a loop.

    A loop whose verdict is not firm, or of which other windows say more than its newest, is suspected where
    it sticks more probably than not.
    """
    if diagnosis is None:
        return "waiting"
    if diagnosis.verdict == "stiction":
        return "sticks"
    if _suspected(diagnosis):
        return "suspected"
    match diagnosis.verdict:
        case "not_testable":
            return "not_testable"
        case "undecided":
            return _of_cause(diagnosis, "undecided")
        case _:
            return _of_cause(diagnosis, "healthy")


def probability_of(diagnosis: Diagnosis | None) -> float | None:
    """Return the probability by which loops are ranked, at the base rate of the plant; None: not known."""
    if diagnosis is None:
        return None
    return diagnosis.probability if diagnosis.sticks is None else diagnosis.sticks.probability


def estimate_of(diagnosis: Diagnosis | None) -> IntervalEstimate | None:
    """Return S where the valve sticks or may stick; None else.

    Where PV does not respond to OP, the stick band of the best fit is the range of OP, and no estimate.
    """
    if diagnosis is None or diagnosis.quantification is None or diagnosis.quantification.stiction is None:
        return None
    may = diagnosis.verdict == "undecided" and diagnosis.no_response is None
    return diagnosis.quantification.stiction.s if diagnosis.verdict == "stiction" or may else None


def _suspected(diagnosis: Diagnosis) -> bool:
    found = diagnosis.quantification
    if diagnosis.sticks is not None:
        return is_suspected(diagnosis)
    return diagnosis.verdict == "undecided" and found is not None and found.decision == "stiction"


def _of_cause(diagnosis: Diagnosis, otherwise: Group) -> Group:
    if diagnosis.cause == "tight_tuning":
        return "tight_tuning"
    return "disturbance" if diagnosis.cause == "external_disturbance" else otherwise
