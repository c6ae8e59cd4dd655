"""What to do next: the group of a diagnosis, and the groups in the order of their urgency."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Literal

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
LIKELY = 0.5
"""Probability from which an undecided loop is suspected."""


def group_of(diagnosis: Diagnosis | None) -> Group:
    """Return the group of a loop."""
    if diagnosis is None:
        return "waiting"
    match diagnosis.verdict:
        case "stiction":
            return "sticks"
        case "not_testable":
            return "not_testable"
        case "undecided":
            return "suspected" if _suspected(diagnosis) else _of_cause(diagnosis, "undecided")
        case _:
            return _of_cause(diagnosis, "healthy")


def estimate_of(diagnosis: Diagnosis | None) -> IntervalEstimate | None:
    """Return S where the valve sticks or may stick; None else."""
    if diagnosis is None or diagnosis.quantification is None or diagnosis.quantification.stiction is None:
        return None
    return diagnosis.quantification.stiction.s if diagnosis.verdict in ("stiction", "undecided") else None


def _suspected(diagnosis: Diagnosis) -> bool:
    probability, found = diagnosis.probability, diagnosis.quantification
    if probability is not None:
        return probability >= LIKELY
    return found is not None and found.decision == "stiction"


def _of_cause(diagnosis: Diagnosis, otherwise: Group) -> Group:
    if diagnosis.cause == "tight_tuning":
        return "tight_tuning"
    return "disturbance" if diagnosis.cause == "external_disturbance" else otherwise
