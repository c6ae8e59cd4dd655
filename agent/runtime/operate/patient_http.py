"""The door of the HTTP server: who connects and sends nothing gives way, and ``/live`` always has room.

uvicorn counts connections that are open against its limit, so that a few silent ones make it answer 503, and
a supervisor restarts a healthy agent. Here a connection has a time in which its request must come, silent
connections are closed first where there are many, and only requests count against the limit.
"""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING

from starlette.responses import PlainTextResponse
from uvicorn.protocols.http.h11_impl import H11Protocol

if TYPE_CHECKING:
    from starlette.types import ASGIApp, Receive, Scope, Send

REQUEST_WITHIN = 5.0
"""Time in which the head of a request must be complete, s."""
MOST_CONNECTIONS = 256
"""Open at a time; beyond, a silent one is closed for each that comes."""
MOST_REQUESTS = 128
"""Answered at a time; more get 503. A browser keeps six."""
FREE = "/live"
"""Is answered in any crowd."""


class PatientProtocol(H11Protocol):
    """A connection that is closed where no request comes."""

    _silence: asyncio.TimerHandle | None = None

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """Begin to wait for a request; where there are many connections a silent one gives way."""
        super().connection_made(transport)
        self._wait()
        if len(self.connections) > MOST_CONNECTIONS:
            silent = (each for each in self.connections if isinstance(each, PatientProtocol) and each.silent)
            loudest = next((each for each in silent if each is not self), self)
            loudest.transport.close()

    def data_received(self, data: bytes) -> None:
        """Take what came; a request that is complete ends the wait."""
        super().data_received(data)
        if self.silent:
            self._wait()
        else:
            self._end_wait()

    def connection_lost(self, exc: Exception | None) -> None:
        """Forget the connection."""
        self._end_wait()
        super().connection_lost(exc)

    @property
    def silent(self) -> bool:
        """Whether no request is being answered."""
        return self.cycle is None or self.cycle.response_complete

    def _wait(self) -> None:
        """Set the time once: who sends a byte now and then does not prolong it."""
        if self._silence is None:
            self._silence = self.loop.call_later(REQUEST_WITHIN, self._close)

    def _end_wait(self) -> None:
        if self._silence is not None:
            self._silence.cancel()
            self._silence = None

    def _close(self) -> None:
        self._silence = None
        if self.silent and not self.transport.is_closing():
            self.transport.close()


class Crowd:
    """Answers so many requests at a time, and ``FREE`` always."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app
        self._answering = 0

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request, or say that there are too many."""
        if scope["type"] == "http" and scope["path"] != FREE and self._answering >= MOST_REQUESTS:
            await PlainTextResponse("too many requests\n", 503, {"Retry-After": "1"})(scope, receive, send)
            return
        self._answering += 1
        try:
            await self._app(scope, receive, send)
        finally:
            self._answering -= 1
