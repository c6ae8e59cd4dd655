"""The work list: loops ranked by what to do next."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Any, Literal

from fastapi import APIRouter, Query
from pydantic import BaseModel, Field
from starlette.responses import Response

from agent.analysis.plant.plant import PlantFinding
from agent.report.fleet.plant_words import plant_json
from agent.report.ranking import estimate_of, probability_of
from agent.runtime.operate.breath import breathing, in_order
from agent.runtime.plant_wide import PlantLook
from agent.web.event_stream import EventStream
from agent.web.plant import Look, Plant
from agent.web.ranking import Item, widest
from agent.web.rows import plain, row_of, sparkline_of
from agent.web.screens.answers import too_many_pages
from agent.web.screens.screen import PageScreen

LARGEST_PAGE = 200
SPARKLINES_EVERY = 5
"""Looks from one sparkline of a row to its next."""
NEVER = float("inf")


class Wanted(BaseModel):
    """Which part of the list a page shows."""

    group: Literal[
        "", "sticks", "suspected", "tight_tuning", "disturbance", "undecided", "not_testable", "healthy",
        "waiting", "stale",
    ] = ""  # fmt: skip
    search: Annotated[str, Field(max_length=100)] = ""
    area: Annotated[str, Field(max_length=200)] = ""
    sort: Literal["next", "name", "s", "probability", "since"] = "next"
    page: Annotated[int, Field(ge=0)] = 0
    size: Annotated[int, Field(ge=1, le=LARGEST_PAGE)] = 50


class Rows:
    """The view of one open work list: only rows that it shows, sparklines now and then."""

    def __init__(self, plant: Plant, wanted: Wanted) -> None:
        self._plant = plant
        self._wanted = wanted
        self._looks = 0
        self._sparklines: dict[str, Any] = {}

    async def __call__(self, look: Look) -> dict[str, object]:
        """Return the parts of the page."""
        parts = await listed(look, self._wanted)
        shown = parts["order"]
        if self._looks % SPARKLINES_EVERY == 0:
            self._sparklines.clear()
        self._looks += 1
        ages: dict[str, int | None] = {}
        async for name in breathing(shown):
            pipeline = self._plant.agent.pipelines.get(name)
            if pipeline is None:
                continue  # the configuration changed meanwhile
            if name not in self._sparklines:
                self._sparklines[name] = sparkline_of(pipeline)
            item = look.by_name[name]
            parts[f"row:{name}"] = row_of(item)
            parts[f"spark:{name}"] = self._sparklines[name]
            ages[name] = None if item.status.data_age is None else round(item.status.data_age)
        parts["ages"] = ages
        return parts


async def listed(look: Look, wanted: Wanted) -> dict[str, Any]:
    """Return the counts of all loops and the names of those that a page shows, in their order.

    Others have their turn meanwhile.
    """
    every = not (wanted.group or wanted.area or wanted.search)
    fit: Sequence[Item] = look.items
    if not every:
        fit = [item async for item in breathing(look.items) if _fits(item, wanted)]
    if wanted.sort != "next":
        fit = await in_order(fit, lambda item: _key(item, wanted.sort))
    first = wanted.page * wanted.size
    return {
        "counts": look.counts,
        "plant": {
            "loops": len(look.items),
            "fitting": len(fit),
            "widest": look.widest if every else widest(fit),
        },
        "order": [item.status.loop for item in fit[first : first + wanted.size]],
    }


async def map_of(look: Look) -> list[dict[str, Any]]:
    """Return the loops of each area: name, group, whether it is stale, and S, the most urgent first."""
    areas: dict[str, list[list[object]]] = {}
    async for item in breathing(look.items):
        s = estimate_of(item.status.diagnosis)
        width = None if s is None else plain(float(f"{s.value:.3g}"))
        areas.setdefault(item.area, []).append([item.status.loop, item.group, int(item.stale), width])
    return [{"area": area, "loops": loops} for area, loops in sorted(areas.items())]


def groups_of(look: PlantLook | None) -> dict[str, Any]:
    """Return what a look at the whole plant found, with the same keys before the first one."""
    finding = PlantFinding((), (), 0.0) if look is None else look.finding
    return {
        "time": None if look is None else look.time,
        "left_out": None if look is None else look.left_out,
        **plant_json(finding),
    }


def screen(plant: Plant) -> PageScreen:
    """Return the screen of a plant."""
    router = APIRouter(prefix="/api/work-list", tags=["work list"])

    @router.get("")
    async def work_list(wanted: Annotated[Wanted, Query()]) -> dict[str, Any]:
        """One page of the list: ranked, filtered and counted."""
        look = await plant.look()
        parts = await listed(look, wanted)
        rows = [row_of(look.by_name[name]) async for name in breathing(parts.pop("order"))]
        return parts | {"rows": rows}

    @router.get("/stream", response_class=Response)
    async def stream(wanted: Annotated[Wanted, Query()]) -> Response:
        """Server-sent events: the page of the list, then what changes in it."""
        page = await plant.live.open(Rows(plant, wanted))
        return too_many_pages() if page is None else EventStream(page, lambda: plant.live.close(page))

    @router.get("/map")
    async def areas() -> list[dict[str, Any]]:
        """Loops by area, each [name, group, stale, S]; S in OP units, null where there is none."""
        return await map_of(await plant.look())

    @router.get("/groups")
    async def groups() -> dict[str, Any]:
        """Loops that oscillate together, each group with its likeliest root and the path from it.

        As of the newest look at the whole plant; `time` is null before the first one.
        """
        return groups_of(plant.agent.plant_wide.newest)

    return PageScreen("work_list", "Work list", "/", router)


def _fits(item: Item, wanted: Wanted) -> bool:
    if wanted.group and not (item.stale if wanted.group == "stale" else item.group == wanted.group):
        return False
    return (
        not wanted.area or item.area == wanted.area
    ) and wanted.search.casefold() in item.status.loop.casefold()


def _key(item: Item, sort: str) -> tuple[float | str, ...]:
    name, diagnosis = item.status.loop, item.status.diagnosis
    if sort == "s":
        s = estimate_of(diagnosis)
        return (NEVER if s is None else -s.value, name)
    if sort == "probability":
        probability = probability_of(diagnosis)
        return (NEVER if probability is None else -probability, name)
    if sort == "since":
        return (NEVER if item.since is None else -item.since, name)
    return (name,)
