"""What a person decides on the page about an alarm: an order as over a bus, kept with its comment."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

from pydantic import BaseModel, Field

from connectors.base import Action, Order

if TYPE_CHECKING:
    from agent.web.plant import Plant

HOUR = 3600.0
"""s"""
CONNECTION = "the page"
"""In the place of a connection's name, for the log."""


class OperatorDecision(BaseModel):
    """One decision."""

    action: Action
    by: Annotated[str, Field(min_length=1, max_length=80)]
    """Who decides."""
    comment: Annotated[str, Field(max_length=1000)] = ""
    """Why."""
    hours: Annotated[float | None, Field(gt=0, le=8760, allow_inf_nan=False)] = None
    """For how long an alarm is shelved; with no other action."""
    alarm: Annotated[str | None, Field(max_length=300)] = None
    """Id of the activation that is meant; None: whichever stands."""


class RepairNote(BaseModel):
    """Work that was done on a valve: it stands in the history of S, to see what it changed."""

    by: Annotated[str, Field(min_length=1, max_length=80)]
    """Who reports it."""
    comment: Annotated[str, Field(min_length=1, max_length=1000)]
    """What was done."""

    def note(self) -> dict[str, str]:
        """Return it as it is kept."""
        return {"action": "repaired", "by": self.by.strip(), "comment": self.comment}


async def decide(plant: Plant, loop: str, decision: OperatorDecision) -> str | None:
    """Obey and keep it; return why it is refused, None where it is not."""
    until = None if decision.hours is None else plant.clock() + decision.hours * HOUR
    order = Order(loop, decision.action, decision.by.strip(), until, decision.alarm)
    problem = await plant.agent.orders.decide(CONNECTION, order)
    if problem is None:
        content = {"action": decision.action, "by": order.by, "comment": decision.comment, "until": until}
        plant.note(loop, content)
    return problem
