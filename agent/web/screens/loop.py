"""One loop: what was measured, what the model says, why the verdict is as it is, and what people decide."""

from __future__ import annotations

from typing import Annotated, Any

from fastapi import APIRouter, HTTPException, Query
from starlette.responses import HTMLResponse, PlainTextResponse, Response

from agent.report.diagnosis_json import diagnosis_json
from agent.web.decisions import OperatorDecision, RepairNote, decide
from agent.web.event_stream import EventStream
from agent.web.judgement import PersonalJudgement
from agent.web.pictures.loop_pictures import map_json, method_picture, profile_json
from agent.web.pictures.loop_print import figure_svg, report, work_order
from agent.web.plant import Look, Plant
from agent.web.rows import numbers, plain, row_of
from agent.web.screens.answers import csv_of, loop_of, opened, too_many_pages
from agent.web.screens.screen import PageScreen

REPORT_POLICY = "default-src 'none'; style-src 'unsafe-inline'; img-src data:; frame-ancestors 'none'"
"""A report carries its own style and pictures and no script at all."""


def screen(plant: Plant) -> PageScreen:
    """Return the screen of a plant's loops."""
    router = APIRouter(prefix="/api/loops", tags=["loops"])

    @router.get("")
    async def loops() -> list[str]:
        """Names of all loops, what needs somebody first."""
        return [item.status.loop for item in (await plant.look()).items]

    @router.get("/{name}")
    async def loop(name: str) -> dict[str, Any]:
        """Settings, newest diagnosis and alarm of a loop."""
        loop_of(plant, name)
        return about(plant, await plant.look(), name)

    @router.get("/{name}/stream", response_class=Response)
    async def stream(name: str) -> Response:
        """Server-sent events: row, newest sample and time of the newest verdict of a loop."""
        loop_of(plant, name)
        page = await plant.live.open(lambda look: _view(plant, look, name))
        return too_many_pages() if page is None else EventStream(page, lambda: plant.live.close(page))

    @router.get("/{name}/window")
    async def window(
        name: str, since: Annotated[float | None, Query(allow_inf_nan=False)] = None
    ) -> dict[str, Any]:
        """Samples that are held of a loop, on its grid, null where missing; all or those after ``since``."""
        held = loop_of(plant, name)
        start, columns = held.window.recent(*([] if since is None else [since]))
        found = {role: numbers(column) for role, column in columns.items()}
        return {"start": start, "ts": held.settings.ts, "columns": found}

    @router.get("/{name}/window.csv", response_class=PlainTextResponse)
    async def window_csv(name: str) -> PlainTextResponse:
        """The same as a recording, for `slipjump diagnose` and `slipjump compare`."""
        held = loop_of(plant, name)
        disposition = {"Content-Disposition": 'attachment; filename="window.csv"'}
        return PlainTextResponse(csv_of(held), media_type="text/csv", headers=disposition)

    @router.get("/{name}/model")
    async def model(name: str) -> dict[str, Any]:
        """The window of the newest diagnosis with PV and valve of its model, where it got one."""
        held = loop_of(plant, name)
        seen, diagnosis = opened(held)
        found = None if diagnosis is None else diagnosis.quantification
        if seen is None or found is None:
            raise HTTPException(
                404, "the newest window of this loop got no model: nothing moved, or no fit was possible"
            )
        return {
            "start": seen.start,
            "ts": seen.ts,
            "op": numbers(seen.op),
            "pv": numbers(seen.pv),
            "sp": numbers(seen.sp),
            "model_pv": numbers(found.model_pv),
            "valve": numbers(found.model_mv),
            "profile": profile_json(found.profile),
        }

    @router.get("/{name}/map")
    async def contour_map(name: str) -> dict[str, Any]:
        """Error of each valve over f_D and f_S on the window of the newest diagnosis, on demand."""
        kept = loop_of(plant, name).fitted
        found = (
            None
            if kept is None
            else await plant.drawing.calculated(("map", name, kept.start), map_json, kept)
        )
        if found is None:
            raise HTTPException(404, "there is no map of this loop: its newest window got no model")
        return found

    @router.get("/{name}/methods/{method}.svg", response_class=Response)
    async def picture(name: str, method: str) -> Response:
        """What one method saw, as a picture."""
        held = loop_of(plant, name)
        kept, diagnosis = held.fitted, held.diagnosis
        drawn = None
        if kept is not None and diagnosis is not None and method in diagnosis.methods:
            key = ("method", name, method, kept.start)
            drawn = await plant.drawing.calculated(key, method_picture, method, kept)
        if drawn is None:
            raise HTTPException(404, f"{method} left nothing to draw")
        return Response(drawn, media_type="image/svg+xml", headers={"Content-Security-Policy": REPORT_POLICY})

    @router.get("/{name}/history")
    async def history(name: str) -> list[dict[str, Any]]:
        """Verdicts, changes of the alarm and decisions of people, the oldest first."""
        loop_of(plant, name)
        entries = await plant.history(name)
        return [{"time": plain(each.time), "kind": each.kind, **each.content} for each in entries]

    @router.get("/{name}/report", response_class=HTMLResponse)
    async def printed(name: str) -> HTMLResponse:
        """The newest diagnosis as one page that needs no other file."""
        held = loop_of(plant, name)
        if held.diagnosis is None:
            raise HTTPException(404, "there is no verdict on this loop yet")
        key = ("report", name, held.judged_at)
        text = await plant.drawing.calculated(key, report, *opened(held), plant.clock())
        return HTMLResponse(text, headers={"Content-Security-Policy": REPORT_POLICY})

    @router.post("/{name}/orders")
    async def order(name: str, decision: OperatorDecision) -> dict[str, Any]:
        """Acknowledge, shelve, unshelve, take out of service or back; the buses get the new state."""
        loop_of(plant, name)
        problem = await decide(plant, name, decision)
        if problem is not None:
            raise HTTPException(409, f"{decision.action} of {name}: {problem}")
        return row_of((await plant.look()).by_name[name])

    @router.post("/{name}/judgement")
    async def judgement(name: str, said: PersonalJudgement) -> dict[str, Any]:
        """Say that a valve sticks or is sound in place of the verdict, or withdraw that; the alarm stays."""
        loop_of(plant, name)
        plant.judge(name, said)
        return row_of((await plant.look()).by_name[name])

    @router.post("/{name}/repair", status_code=204)
    async def repaired(name: str, said: RepairNote) -> Response:
        """Say that a valve was repaired: the history of S shows when and what."""
        loop_of(plant, name)
        plant.note(name, dict(said.note()))
        return Response(status_code=204)

    @router.get("/{name}/work-order", response_class=HTMLResponse)
    async def ordered(name: str) -> HTMLResponse:
        """A work order for the workshop, to be printed: finding, picture, S, proposed test, lines to sign."""
        held = loop_of(plant, name)
        if held.diagnosis is None:
            raise HTTPException(404, "there is no verdict on this loop yet")
        key = ("work order", name, held.judged_at)
        text = await plant.drawing.calculated(key, work_order, *opened(held), plant.clock())
        return HTMLResponse(text, headers={"Content-Security-Policy": REPORT_POLICY})

    @router.get("/{name}/figure.svg", response_class=Response)
    async def figure(name: str) -> Response:
        """The judged window with its model as a picture."""
        held = loop_of(plant, name)
        seen, diagnosis = opened(held)
        if seen is None or diagnosis is None:
            raise HTTPException(404, "the newest window of this loop got no model")
        drawn = await plant.drawing.calculated(("figure", name, seen.start), figure_svg, seen, diagnosis)
        disposition = {"Content-Disposition": 'attachment; filename="figure.svg"'}
        headers = {"Content-Security-Policy": REPORT_POLICY, **disposition}
        return Response(drawn, media_type="image/svg+xml", headers=headers)

    return PageScreen("loop", "", "/loops/{name}", router)


def about(plant: Plant, look: Look, name: str) -> dict[str, Any]:
    """Return all that is known of a loop but its samples."""
    held, item = plant.agent.pipelines[name], look.by_name[name]
    settings, kept = held.settings, held.fitted
    diagnosis = None
    if held.diagnosis is not None:
        diagnosis = diagnosis_json(held.diagnosis, "")
        del diagnosis["recording"]
    return {
        "row": row_of(item),
        "settings": {
            "ts": settings.ts,
            "acting": settings.acting,
            "integrating": settings.integrating,
            "op_range": settings.op_range,
            "roles": list(settings.roles),
            "on_delay": settings.alarm.on_delay,
            "off_delay": settings.alarm.off_delay,
        },
        "counters": {
            "samples": item.status.samples,
            "bad": item.status.bad,
            "gaps": item.status.gaps,
            "superseded": item.status.superseded,
        },
        "diagnosis": diagnosis,
        "window": None if kept is None else {"start": kept.start, "seconds": kept.seconds},
    }


def _view(plant: Plant, look: Look, name: str) -> dict[str, object]:
    """Return the parts of an open loop page; none of a loop that the configuration no longer has."""
    held = plant.agent.pipelines.get(name)
    if held is None or name not in look.by_name:
        return {"gone": True}
    return {
        "row": row_of(look.by_name[name]),
        "newest": plain(held.window.newest),
        "judged": held.judged_at,
        "busy": held.busy,
    }
