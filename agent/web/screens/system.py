"""The agent itself: connections, rates, refusals, and loops that never got data."""

from __future__ import annotations

from typing import Any

from fastapi import APIRouter
from starlette.responses import Response

from agent.runtime.operate.health_json import agent_json
from agent.web.event_stream import EventStream
from agent.web.plant import Look, Plant
from agent.web.screens.answers import too_many_pages
from agent.web.screens.screen import PageScreen

SHOWN = 200
"""Loops without data that are listed."""


class Rates:
    """The view of one open page: samples per second come from the look before."""

    def __init__(self, plant: Plant) -> None:
        self._plant = plant
        self._former: tuple[float, dict[str, int]] | None = None

    def __call__(self, look: Look) -> dict[str, object]:
        """Return the parts of the page."""
        samples: dict[str, int] = {}
        ages: dict[str, float] = {}
        loops: dict[str, int] = {}
        for each in look.status.loops:
            samples[each.connection] = samples.get(each.connection, 0) + each.samples
            loops[each.connection] = loops.get(each.connection, 0) + 1
            if each.data_age is not None:
                ages[each.connection] = min(each.data_age, ages.get(each.connection, each.data_age))
        former, self._former = self._former, (look.time, samples)
        counters = agent_json(look.status)
        del counters["connections"]
        return {
            "agent": counters | {"summary": self._plant.agent.summary},
            "silent": silent_loops(look),
            **{
                f"connection:{each.connection}": {
                    "connection": each.connection,
                    "bus": each.bus,
                    "up": each.up,
                    "problem": each.problem,
                    "loops": loops.get(each.connection, 0),
                    "rate": _rate(each.connection, look.time, samples, former),
                    "age": round(ages[each.connection]) if each.connection in ages else None,
                    "losses": each.losses,
                    "faults": each.faults,
                    "malformed": each.malformed,
                    "waiting": each.waiting,
                    "refused": each.refused,
                    "dropped": each.dropped,
                    "oldest": None if each.oldest is None else round(each.oldest),
                    "refusals": self._refusals(each.connection),
                }
                for each in look.status.connections
            },
        }

    def _refusals(self, connection: str) -> list[str]:
        """Return what the peer said about what it would not take."""
        outbox = self._plant.agent.outboxes.get(connection)
        return [] if outbox is None else list(outbox.refusals.reasons)


def silent_loops(look: Look) -> dict[str, Any]:
    """Return the loops that never got data, and those whose data are old."""
    never = [each.loop for each in look.status.loops if each.data_age is None]
    stale = [each.loop for each in look.status.loops if each.data == "stale" and each.data_age is not None]
    return {
        "never": never[:SHOWN],
        "never_count": len(never),
        "stale": stale[:SHOWN],
        "stale_count": len(stale),
    }


def screen(plant: Plant) -> PageScreen:
    """Return the screen of an agent."""
    router = APIRouter(prefix="/api/system", tags=["system"])

    @router.get("")
    async def system() -> dict[str, object]:
        """Connections, counters, and loops without data."""
        return Rates(plant)(await plant.look())

    @router.get("/stream", response_class=Response)
    async def stream() -> Response:
        """Server-sent events: the same, then what changes."""
        page = await plant.live.open(Rates(plant))
        return too_many_pages() if page is None else EventStream(page, lambda: plant.live.close(page))

    return PageScreen("system", "System", "/system", router)


def _rate(
    connection: str, now: float, samples: dict[str, int], former: tuple[float, dict[str, int]] | None
) -> float | None:
    """Return samples per second since the look before; None at the first."""
    if former is None or now <= former[0]:
        return None
    return round(max(samples.get(connection, 0) - former[1].get(connection, 0), 0) / (now - former[0]), 1)
