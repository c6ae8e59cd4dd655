"""The list of alarms after ISA-18.2, and who did what."""

from __future__ import annotations

from typing import Any

from fastapi import APIRouter
from starlette.responses import Response

from agent.alarms import State
from agent.web.event_stream import EventStream
from agent.web.plant import Look, Plant
from agent.web.rows import plain, row_of
from agent.web.screens.answers import too_many_pages
from agent.web.screens.screen import PageScreen

ORDER = (
    State.UNACKED_ACTIVE,
    State.RETURNED_UNACKED,
    State.ACKED_ACTIVE,
    State.SHELVED,
    State.OUT_OF_SERVICE,
)
"""What needs somebody first."""
DECISIONS = 100
"""Of people, shown."""


def alarms_of(look: Look) -> list[dict[str, Any]]:
    """Return every alarm that is not normal, those that nobody acknowledged first."""
    there = [item for item in look.items if item.alarm.state is not State.NORMAL]
    there.sort(key=lambda item: (ORDER.index(item.alarm.state), item.spot))
    return [row_of(item) | {"id": item.alarm.id, "ne107": item.alarm.health.name.lower()} for item in there]


def screen(plant: Plant) -> PageScreen:
    """Return the screen of a plant's alarms."""
    router = APIRouter(prefix="/api/alarms", tags=["alarms"])

    @router.get("")
    async def alarms() -> list[dict[str, Any]]:
        """Every alarm that is not normal."""
        return alarms_of(await plant.look())

    @router.get("/stream", response_class=Response)
    async def stream() -> Response:
        """Server-sent events: the list, then the list again when it changes."""
        page = await plant.live.open(lambda look: {"alarms": alarms_of(look)})
        return too_many_pages() if page is None else EventStream(page, lambda: plant.live.close(page))

    @router.get("/decisions")
    async def decisions() -> list[dict[str, Any]]:
        """Changes of alarms and decisions of people, the newest first."""
        entries = [each for each in await plant.history(None) if each.kind != "diagnosis"]
        return [
            {"time": plain(each.time), "loop": each.loop, "kind": each.kind, **each.content}
            for each in entries[: -DECISIONS - 1 : -1]
        ]

    return PageScreen("alarms", "Alarms", "/alarms", router)
