"""What to do next in a plant: each loop in a group, and the groups in their order."""

from __future__ import annotations

import string
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from agent.alarms import State

if TYPE_CHECKING:
    from agent.alarms import Alarm
    from agent.analysis.diagnosis import Diagnosis
    from agent.analysis.results import IntervalEstimate
    from agent.runtime.operate.status import LoopStatus

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
PRIORITIES = {"critical": 0, "high": 1, "medium": 2, "low": 3}
LIKELY = 0.5
"""Probability from which an undecided loop is suspected."""


@dataclass(frozen=True, slots=True)
class Item:
    """One loop of the work list."""

    status: LoopStatus
    alarm: Alarm
    group: Group
    area: str
    since: float | None
    """Time from which the verdict is as it is, s UTC."""
    spot: int
    """Place in the ranking, 0 first."""

    @property
    def stale(self) -> bool:
        """Whether nothing came in for too long."""
        return self.status.data == "stale"


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


def probability_of(diagnosis: Diagnosis | None) -> float | None:
    """Return the probability that the valve sticks, 0 to 1; None where it is not known."""
    return None if diagnosis is None else diagnosis.probability


def urgency(status: LoopStatus, alarm: Alarm, group: Group) -> tuple[float, ...]:
    """Return the key of the ranking, the least first.

    An alarm that nobody acknowledged comes first, what somebody silenced after all that needs a look; within
    a group the higher priority, the higher probability, then the wider stick band.
    """
    unacknowledged = alarm.state in {State.UNACKED_ACTIVE, State.RETURNED_UNACKED}
    s = estimate_of(status.diagnosis)
    return (
        not unacknowledged,
        ORDER[group] if not alarm.state.silenced else ORDER["healthy"] + 0.5,
        PRIORITIES[alarm.priority],
        -(probability_of(status.diagnosis) or 0.0),
        -(s.value if s is not None else 0.0),
    )


def estimate_of(diagnosis: Diagnosis | None) -> IntervalEstimate | None:
    """Return S where the valve sticks or may stick; None else."""
    if diagnosis is None or diagnosis.quantification is None or diagnosis.quantification.stiction is None:
        return None
    return diagnosis.quantification.stiction.s if diagnosis.verdict in ("stiction", "undecided") else None


def area_of(loop: str, variables: Mapping[str, str]) -> str:
    """Return the area of a loop: its variable ``area`` or ``unit``, or what its name begins with.

    ``11-FIC-204`` is in area 11; ``FIC204`` in 2xx, as plants number loops by unit.
    """
    for name in ("area", "unit"):
        if name in variables:
            return variables[name]
    for separator in "-_:":
        first, found, _ = loop.partition(separator)
        if found and first:
            return first
    digits = loop.lstrip(string.ascii_letters)
    return f"{digits[:-2]}xx" if digits.isdigit() and len(digits) > 2 else "plant"


def _suspected(diagnosis: Diagnosis) -> bool:
    probability, found = probability_of(diagnosis), diagnosis.quantification
    if probability is not None:
        return probability >= LIKELY
    return found is not None and found.decision == "stiction"


def _of_cause(diagnosis: Diagnosis, otherwise: Group) -> Group:
    if diagnosis.cause == "tight_tuning":
        return "tight_tuning"
    return "disturbance" if diagnosis.cause == "external_disturbance" else otherwise
