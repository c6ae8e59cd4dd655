"""What to do next in a plant: each loop in a group, and the groups in their order."""

from __future__ import annotations

import string
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from agent.alarms import State
from agent.report.ranking import ORDER, estimate_of, probability_of

if TYPE_CHECKING:
    from agent.alarms import Alarm
    from agent.report.ranking import Group
    from agent.runtime.operate.status import LoopStatus
    from agent.web.judgement import Judgement

PRIORITIES = {"critical": 0, "high": 1, "medium": 2, "low": 3}


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
    judgement: Judgement | None = None
    """Of a person, in place of the verdict; None: there is none."""

    @property
    def stale(self) -> bool:
        """Whether nothing came in for too long."""
        return self.status.data == "stale"


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


def widest(items: Iterable[Item], known: float | None = None) -> float | None:
    """Return the upper end of the widest interval of S, OP units: the scale of the bars; None without any.

    ``known`` is that of other items.
    """
    found = [s for s in (estimate_of(item.status.diagnosis) for item in items) if s is not None]
    ends = [s.value if s.high is None else s.high for s in found]
    return max(ends if known is None else [known, *ends], default=None)


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
