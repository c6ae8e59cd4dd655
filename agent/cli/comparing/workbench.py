"""``slipjump workbench``: the workbench alone in a browser, without a plant or a configuration."""

from __future__ import annotations

import asyncio
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from agent.cli.common.errors import BAD_INPUT, complain

if TYPE_CHECKING:
    from agent.settings import HttpSettings
    from agent.web.workbench.desk import Opening
    from agent.web.workbench.sessions import Sessions, WorkbenchSession

PORT = 9189
"""Tried first where no port is given."""


def workbench(
    recording: Annotated[
        Path | None,
        typer.Argument(metavar="[RECORDING]", help="Opened at once; others are uploaded on the page."),
    ] = None,
    *,
    host: Annotated[
        str,
        typer.Option(metavar="H", help="Address on which it listens; beyond this machine a token is needed."),
    ] = "127.0.0.1",
    port: Annotated[
        int | None,
        typer.Option(
            min=1, max=65535, metavar="P", help=f"[default: {PORT}, or a free one]", show_default=False
        ),
    ] = None,
    browser: Annotated[
        bool, typer.Option("--browser/--no-browser", help="Open the page in the browser of this machine.")
    ] = True,
) -> None:
    """Compare a model with a recording in the browser: see where it fails, tick the missing effect.

    Prints the address when the page can be opened and goes on until Ctrl-C.
    With --host for other machines a token is made and printed; the page
    wants it once.
    """
    open_page(recording, host=host, port=port, browser=browser)


def open_page(
    recording: Path | None,
    base: str = "fopdt",
    *,
    host: str = "127.0.0.1",
    port: int | None = None,
    browser: bool = True,
) -> None:
    """Serve the workbench until Ctrl-C; exit with 2 where that is not possible.

    Args:
        recording: Opened at once; None: none.
        base: Process with which its model begins.
        host: Where to listen; a token is made where others can reach it.
        port: None: the usual one, or one that is free.
        browser: Open the page in the browser of this machine.
    """
    from agent.cli.common.page import free_port
    from agent.settings import HttpSettings
    from agent.web.workbench.desk import Opening

    if recording is not None and not recording.is_file():
        complain(f"{recording}: no such file")
        raise typer.Exit(BAD_INPUT)
    settings = HttpSettings.model_construct(host=host, port=free_port(PORT) if port is None else port)
    opening = None if recording is None else Opening(recording.resolve(), recording.name, base)
    asyncio.run(_served(settings, opening, browser=browser))


async def _served(settings: HttpSettings, opening: Opening | None, *, browser: bool) -> None:
    import contextlib
    import secrets

    from agent.runtime.capabilities import on_signals
    from agent.runtime.operate.http import serve_app
    from agent.web.access import LOOPBACK, Access
    from agent.web.app import application
    from agent.web.plant_page import address
    from agent.web.screens import workbench as page
    from agent.web.workbench.sessions import Sessions
    from connectors.base import ConnectionLostError

    sessions = Sessions()
    token = None if settings.is_loopback else secrets.token_urlsafe(18)
    access = Access(token, LOOPBACK | {settings.host} if settings.is_loopback else None)
    session = None if opening is None else sessions.create()
    first = [] if session is None else [page.leads_to(sessions, session.name)]
    app = application([page.screen(sessions, path="/")], access, first)
    ready, end = asyncio.Event(), asyncio.Event()
    on_signals({"SIGINT": end.set, "SIGTERM": end.set})
    serving = asyncio.create_task(serve_app(app, settings.host, settings.port, ready.set), name="page")
    looking = asyncio.create_task(sessions.run(), name="sessions")
    ended = asyncio.create_task(end.wait(), name="signals")
    came = asyncio.create_task(ready.wait(), name="listens")
    try:
        await asyncio.wait({serving, came, ended}, return_when=asyncio.FIRST_COMPLETED)
        if came.done():
            place = address(settings)
            if token is not None:
                _say(f"token: {token}")
            _say(f"address: {place}")
            if opening is not None and session is not None:
                await _opened(sessions, opening, session)
            if browser:
                import webbrowser

                await asyncio.to_thread(webbrowser.open, place)
            await asyncio.wait({serving, ended}, return_when=asyncio.FIRST_COMPLETED)
        if serving.done():
            serving.result()
    except ConnectionLostError as error:
        complain(f"{settings.host}:{settings.port}: {error}")
        raise typer.Exit(BAD_INPUT) from error
    finally:
        for task in (serving, looking, ended, came):
            task.cancel()
        with contextlib.suppress(asyncio.CancelledError):
            await asyncio.wait({serving, looking, ended, came})


async def _opened(sessions: Sessions, opening: Opening, session: WorkbenchSession) -> None:
    """Open a recording in a session; exit with 2 where it cannot be read."""
    from agent.web.workbench.sessions import WorkbenchError, opened

    try:
        await opened(sessions, opening, session)
    except WorkbenchError as error:
        complain(str(error))
        raise typer.Exit(BAD_INPUT) from error


def _say(line: str) -> None:
    print(line, flush=True)  # noqa: T201 - the command's output
