"""Workbench: compare a model with a recording, see where it fails, tick the missing effect."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import PurePosixPath
from typing import Annotated, Any

from fastapi import APIRouter, Depends, HTTPException, Query, Request
from pydantic import BaseModel, Field
from starlette.responses import HTMLResponse, JSONResponse, RedirectResponse, Response
from starlette.routing import Route

from agent.web.app import shell
from agent.web.event_stream import EventStream
from agent.web.screens.answers import too_many_pages
from agent.web.screens.loop import REPORT_POLICY
from agent.web.screens.screen import PageScreen
from agent.web.workbench.desk import Opening
from agent.web.workbench.sessions import Sessions, WorkbenchError, WorkbenchSession, opened

LARGEST = 64 * 1024 * 1024
"""Largest recording that is taken, bytes: a month of a loop at 1 s as CSV."""
MOST_PAGES = 16
"""Open streams of one session."""
SAFE_NAME = 120
"""Characters of a file's name that are kept."""
Name = Annotated[str, Query(min_length=1, max_length=300)]
LONGEST_TS = 1e7
"""s, of an upload: a third of a year."""
ColumnName = Annotated[str | None, Query(max_length=200)]
Live = Callable[[str], bytes | None]
"""Returns the held window of a loop as CSV; None where there is no such loop."""


def leads_to(sessions: Sessions, name: str) -> Route:
    """Return the route of ``/`` that leads to a session that is open already, while it is."""

    async def root(request: Request) -> Response:
        if name in sessions.open and not request.query_params:
            return RedirectResponse(f"/?session={name}", headers={"Cache-Control": "no-store"})
        return await shell(request)

    return Route("/", root)


class EffectChange(BaseModel):
    """An effect that is added or taken out."""

    effect: Annotated[str, Field(min_length=1, max_length=80)]


class NodeChoice(BaseModel):
    """A step of the tree."""

    number: Annotated[int, Field(ge=0)]


class LeftOut(BaseModel):
    """A stretch of the record, s from its start."""

    start: Annotated[float, Field(allow_inf_nan=False)]
    end: Annotated[float, Field(allow_inf_nan=False)]


class OwnValues(BaseModel):
    """Parameters by their names, in their units."""

    values: dict[str, Annotated[float, Field(allow_inf_nan=False)]]


class OwnColumns(BaseModel):
    """Columns of the recording by role: time, OP, PV, SP, and ts in s; what is empty is recognised."""

    columns: dict[str, Annotated[str, Field(max_length=200)]]


@dataclass(frozen=True, slots=True)
class ColumnRoles:
    """Columns of an upload by role, where they are not to be recognised."""

    time: ColumnName = None
    op: ColumnName = None
    pv: ColumnName = None
    sp: ColumnName = None
    ts: Annotated[float | None, Query(gt=0, le=LONGEST_TS)] = None
    """Sampling time, s, of a file without a time column."""

    def by_role(self) -> dict[str, str]:
        """Return what was named."""
        named = {"time": self.time, "OP": self.op, "PV": self.pv, "SP": self.sp}
        known = {role: column for role, column in named.items() if column}
        return known if self.ts is None else {**known, "ts": repr(self.ts)}


def screen(sessions: Sessions, live: Live | None = None, path: str = "/workbench") -> PageScreen:
    """Return the screen.

    Args:
        sessions: Of this server.
        live: Gives windows of the plant; None: there is no plant.
        path: Address of the screen.
    """
    router = APIRouter(prefix="/api/workbench", tags=["workbench"])

    def session_of(name: str) -> WorkbenchSession:
        found = sessions.open.get(name)
        if found is None:
            raise HTTPException(404, "this session has ended; open the recording again")
        return found

    async def done(name: str, command: str, *arguments: object, quiet: bool = False) -> Any:  # noqa: ANN401
        try:
            return await session_of(name).command(command, *arguments, quiet=quiet)
        except WorkbenchError as error:
            raise HTTPException(422, str(error)) from error

    async def begun(
        content: bytes, name: str, base: str, columns: Mapping[str, str] | None = None
    ) -> Response:
        try:
            session = sessions.create()
        except WorkbenchError as error:
            raise HTTPException(409, str(error)) from error
        stored = await asyncio.to_thread(_stored, session, content, name, base)
        try:
            await opened(sessions, replace(stored, columns=columns), session)
        except WorkbenchError as error:
            return JSONResponse({"detail": str(error), "columns": session.names}, 422)
        return JSONResponse({"session": session.name})

    @router.get("/sessions")
    async def all_sessions() -> dict[str, Any]:
        """Sessions that are open."""
        return {
            "live": live is not None,
            "largest": LARGEST,
            "sessions": [
                {"session": each.name, "recording": (each.state or {}).get("recording")}
                for each in sessions.open.values()
                if not each.ended
            ],
        }

    @router.post("/sessions", response_class=JSONResponse)
    async def create(
        request: Request, name: Name, own: Annotated[ColumnRoles, Depends()], base: Name = "fopdt"
    ) -> Response:
        """Begin a session with a recording: the body is the file, `name` its name.

        Columns that are not recognised are named by `time`, `op`, `pv` and `sp`, without a time column the
        sampling time by `ts`, in s; the answer 422 has the columns of the file.
        """
        return await begun(await request.body(), name, base, own.by_role())

    @router.post("/loops/{name}", response_class=JSONResponse)
    async def create_live(name: str) -> Response:
        """Begin a session with the window that is held of a loop of the plant."""
        content = None if live is None else live(name)
        if content is None:
            raise HTTPException(404, f"no loop is called {name}")
        return await begun(content, f"{name}.csv", "fopdt")

    @router.get("/sessions/{name}")
    async def state(name: str) -> dict[str, Any]:
        """Steps, curves, axes, candidates and verdict of the step that is looked at."""
        return session_of(name).state or {}

    @router.delete("/sessions/{name}", status_code=204)
    async def end(name: str) -> Response:
        """End a session and remove its files."""
        sessions.end(name)
        return Response(status_code=204)

    @router.get("/sessions/{name}/stream", response_class=Response)
    async def stream(name: str) -> Response:
        """Server-sent events: version of the state, progress, first curve of a fit, fault."""
        session = session_of(name)
        if len(session.pages) >= MOST_PAGES:
            return too_many_pages()
        page = session.page()
        return EventStream(page, lambda: session.pages.discard(page))

    @router.post("/sessions/{name}/tick")
    async def tick(name: str, change: EffectChange) -> None:
        """Add an effect and fit everything again."""
        await done(name, "tick", change.effect)

    @router.post("/sessions/{name}/untick")
    async def untick(name: str, change: EffectChange) -> None:
        """Take an effect out; the step before it is kept, so this is immediate where it was the last."""
        await done(name, "untick", change.effect)

    @router.post("/sessions/{name}/go")
    async def go(name: str, choice: NodeChoice) -> None:
        """Look at another step of the tree; nothing is fitted again."""
        await done(name, "go", choice.number)

    @router.post("/sessions/{name}/leave-out")
    async def leave_out(name: str, stretch: LeftOut) -> None:
        """Fit everything again without a stretch."""
        await done(name, "leave_out", stretch.start, stretch.end)

    @router.post("/sessions/{name}/simulate")
    async def simulate(name: str, own: OwnValues) -> dict[str, Any]:
        """The curve of the model with values of the user."""
        found: dict[str, Any] = await done(name, "simulate", own.values, quiet=True)
        return found

    @router.post("/sessions/{name}/fit-from")
    async def fit_from(name: str, own: OwnValues) -> None:
        """Fit the model again, from values of the user."""
        await done(name, "fit_from", own.values)

    @router.get("/sessions/{name}/axis/{axis}")
    async def against(name: str, axis: str) -> dict[str, Any]:
        """The residual against an axis: bins, band, points."""
        found: dict[str, Any] = await done(name, "against", axis, quiet=True)
        return found

    @router.get("/sessions/{name}/columns")
    async def names(name: str) -> list[str]:
        """Columns of the recording, to choose from."""
        found: list[str] = await done(name, "names", quiet=True)
        return found

    @router.post("/sessions/{name}/columns")
    async def columns(name: str, own: OwnColumns) -> None:
        """Read the recording again by other columns; its steps begin anew."""
        session = session_of(name)
        known = session.source
        if known is None:
            raise HTTPException(409, "no recording is open in this session")
        changed = Opening(known.file, known.name, known.base, own.columns)
        await done(name, "open", changed)
        session.source = changed

    @router.post("/validation")
    async def validate(request: Request, session: Name, name: Name) -> None:
        """Score each step of a session on another recording of the loop: the body is the file."""
        found = session_of(session)
        opening = await asyncio.to_thread(_stored, found, await request.body(), f"other-{name}", "fopdt")
        columns = None if found.source is None else found.source.columns  # as the user chose them
        await done(session, "validate", replace(opening, columns=columns))

    @router.get("/sessions/{name}/report", response_class=HTMLResponse)
    async def report(name: str) -> HTMLResponse:
        """The report of the steps on the way to the one that is looked at, as one page."""
        page = await done(name, "report", quiet=True)
        disposition = {"Content-Disposition": 'attachment; filename="comparison.html"'}
        return HTMLResponse(page, headers={"Content-Security-Policy": REPORT_POLICY, **disposition})

    uploads = {"/api/workbench/sessions": LARGEST, "/api/workbench/validation": LARGEST}
    return PageScreen("workbench", "Workbench", path, router, uploads)


def _stored(session: WorkbenchSession, content: bytes, name: str, base: str) -> Opening:
    """Write a recording into a folder of its own; of its name only plain letters are kept on disk."""
    own = PurePosixPath(name.replace("\\", "/")).name[-SAFE_NAME:] or "recording.csv"
    folder = session.folder / str(len(list(session.folder.iterdir())))
    folder.mkdir()
    plain = "".join(
        letter if letter.isascii() and (letter.isalnum() or letter in "-_.") else "_" for letter in own
    )
    file = folder / (plain.lstrip(".") or "recording.csv")
    file.write_bytes(content)
    return Opening(file, own, base)
