"""Health and metrics over HTTP, to monitor the daemon itself."""

from __future__ import annotations

import asyncio
import contextlib
import hmac
import socket
from collections.abc import Awaitable, Callable, Iterator
from typing import Protocol

import uvicorn
from prometheus_client import CONTENT_TYPE_LATEST
from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import PlainTextResponse, Response, StreamingResponse
from starlette.routing import Route
from starlette.types import ASGIApp

from agent.runtime.operate.health_json import health_text
from agent.runtime.operate.metrics import Metrics
from agent.runtime.operate.patient_http import MOST_CONNECTIONS, Crowd, PatientProtocol
from agent.runtime.operate.status import AgentStatus
from agent.settings import HttpSettings
from connectors.base import AccessDeniedError, ConnectionLostError
from connectors.reuse import listen_again

IDLE = 5
"""Time after which an idle client is disconnected, s."""
DATE = 1.0
"""Resolution of the date of an answer, s."""
AT_ONCE = 64
"""Connections that are accepted before the next look at those that must go: a crowd takes no more files."""
Handler = Callable[[Request], Awaitable[Response]]
PageOf = Callable[[Starlette, HttpSettings, str | None], ASGIApp]
"""Builds the whole application around the monitoring routes; it is given the settings and the token."""


class Watched(Protocol):
    """The daemon, as monitoring looks at it."""

    def hung(self) -> tuple[str, ...]:
        """Return the tasks that hang."""
        ...

    async def looked(self) -> AgentStatus:
        """Return the state of all loops and connections."""
        ...


class _Server(uvicorn.Server):
    """uvicorn without its own signal handlers: signals are for the daemon. It sleeps until it is to end."""

    def __init__(self, config: uvicorn.Config) -> None:
        super().__init__(config)
        self._ending = asyncio.Event()

    def end(self) -> None:
        """Have ``serve`` return."""
        self.should_exit = True
        self._ending.set()

    async def main_loop(self) -> None:
        """Keep the date of the answers; uvicorn's own wakes ten times a second."""
        while not await self.on_tick(0):
            with contextlib.suppress(TimeoutError):
                async with asyncio.timeout(DATE):
                    await self._ending.wait()

    @contextlib.contextmanager
    def capture_signals(self) -> Iterator[None]:
        yield


def application(watched: Watched, metrics: Metrics, token: str | None) -> Starlette:
    """Return the ASGI application.

    /live says whether the program itself works, for who may start it anew; /health also whether the plant is
    there. Both answer 200 or 503.

    Args:
        watched: The daemon.
        metrics: Of the daemon.
        token: What a client must show but for /live; None: nothing.
    """

    async def live(_: Request) -> Response:
        hung = watched.hung()
        return PlainTextResponse("hung\n" if hung else "ok\n", 503 if hung else 200)

    async def health(_: Request) -> Response:
        status = await watched.looked()
        code = 200 if status.ok else 503
        return Response(await health_text(status), code, media_type="application/json")

    async def numbers(_: Request) -> Response:
        return StreamingResponse(metrics.parts(), media_type=CONTENT_TYPE_LATEST)

    def guarded(handler: Handler) -> Handler:
        async def checked(request: Request) -> Response:
            if token is None or _shows(request, token):
                return await handler(request)
            return PlainTextResponse(
                "expected a token: Authorization: Bearer TOKEN\n", 401, {"WWW-Authenticate": "Bearer"}
            )

        return checked

    app = Starlette(
        routes=[
            Route("/live", live),
            Route("/health", guarded(health)),
            Route("/metrics", guarded(numbers)),
        ]
    )
    app.router.redirect_slashes = False  # it would lead to whatever host the caller named
    return app


async def serve(
    settings: HttpSettings,
    watched: Watched,
    metrics: Metrics,
    listens: Callable[[], None],
    page_of: PageOf | None = None,
) -> None:
    """Serve until cancelled; raises ConnectionLostError where the address cannot be had.

    The token is read anew at each start; ``listens`` is called when clients can come. ``page_of`` adds a page
    around the monitoring routes and then checks the token for all of them; None: there is no page.
    """
    token = None if settings.token is None else settings.token.read("agent.http.token")
    if token == "":
        raise AccessDeniedError("agent.http.token: is empty")
    app: ASGIApp = (
        application(watched, metrics, token)
        if page_of is None
        else page_of(application(watched, metrics, None), settings, token)
    )
    await serve_app(app, settings.host, settings.port, listens)


async def serve_app(app: ASGIApp, host: str, port: int, listens: Callable[[], None]) -> None:
    """Serve an application until cancelled; ConnectionLostError where the address cannot be had.

    ``listens`` is called when clients can come.
    """
    server = _Server(
        uvicorn.Config(
            Crowd(app),
            log_config=None,
            access_log=False,
            lifespan="off",
            http=PatientProtocol,
            ws="none",
            server_header=False,
            timeout_keep_alive=IDLE,
            backlog=AT_ONCE,
            timeout_graceful_shutdown=1,
        )
    )
    with _bound(host, port) as listener:
        listens()
        work = asyncio.create_task(server.serve(sockets=[listener]), name="http server")
        try:
            await asyncio.shield(work)
        finally:
            server.end()
            await asyncio.wait({work})


def _bound(host: str, port: int) -> socket.socket:
    """Return a socket that listens; uvicorn itself would end the program where it cannot."""
    try:
        (family, kind, number, _, address), *_ = socket.getaddrinfo(
            host, port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE
        )
        listener = socket.socket(family, kind, number)
        try:
            listen_again(listener)
            listener.bind(address)
            listener.listen(MOST_CONNECTIONS)
        except OSError:
            listener.close()
            raise
    except OSError as error:
        raise ConnectionLostError(f"cannot listen: {error.strerror}") from error
    return listener


def _shows(request: Request, token: str) -> bool:
    shown = request.headers.get("authorization", "")
    return hmac.compare_digest(shown.encode(), f"Bearer {token}".encode())
