"""The whole page as one application of ASGI, out of its screens."""

from __future__ import annotations

from collections.abc import Sequence
from importlib.metadata import version
from pathlib import Path

from fastapi import FastAPI, HTTPException, Request
from fastapi.responses import FileResponse
from starlette.middleware.gzip import GZipMiddleware
from starlette.routing import BaseRoute, Route
from starlette.staticfiles import StaticFiles
from starlette.types import ASGIApp

from agent.web.access import Access
from agent.web.guard import Guard
from agent.web.screens.screen import PageScreen

STATIC = Path(__file__).parent / "static"
COMPRESSED = 1000
"""Answers from this size on are compressed, bytes."""
REFERENCE = "/api/docs"
"""Where the interface is described, from ``/api/openapi.json``, drawn by the screen ``reference``."""


async def shell(_: Request) -> FileResponse:
    """Answer with the page that every screen is drawn in."""
    return FileResponse(STATIC / "index.html", headers={"Cache-Control": "no-cache"})


def application(
    screens: Sequence[PageScreen], access: Access, others: Sequence[BaseRoute] = (), title: str = "slipjump"
) -> ASGIApp:
    """Return the application.

    Args:
        screens: In the order of the navigation; the first that fits an address draws it.
        access: Who may do what.
        others: Routes beside, such as ``/live``; they come first.
        title: Name of the plant.
    """
    app = FastAPI(
        title="slipjump",
        version=version("slipjump"),
        docs_url=None,
        redoc_url=None,
        openapi_url="/api/openapi.json",
        redirect_slashes=False,  # it would lead to whatever host the caller named
    )
    app.router.routes.extend(others)

    @app.get("/api/session", tags=["session"])
    async def session(request: Request) -> dict[str, object]:
        """Screens of this page, and the CSRF token that each request which changes state must carry."""
        return {
            "title": title,
            "version": app.version,
            "csrf": access.csrf_token(request.state.session),
            "signed_in": access.token is not None,
            "screens": [{"name": each.name, "title": each.title, "path": each.path} for each in screens]
            + [{"name": "reference", "title": "", "path": REFERENCE}],
        }

    async def nothing() -> None:
        raise HTTPException(404, "there is nothing of this name")

    for screen in screens:
        app.include_router(screen.router)
    app.add_api_route("/api/{rest:path}", nothing, methods=["GET", "POST"], include_in_schema=False)
    app.router.routes.extend(Route(path, shell) for path in [*dict.fromkeys(each.path for each in screens)])
    app.mount("/static", StaticFiles(directory=STATIC), name="static")
    app.router.routes.insert(0, Route(REFERENCE, shell))
    app.add_middleware(GZipMiddleware, minimum_size=COMPRESSED)
    uploads = {path: limit for screen in screens for path, limit in screen.uploads.items()}
    return Guard(app, access, uploads)
