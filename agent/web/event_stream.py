"""Server-sent events as an answer of ASGI: what a page is offered, and a sign of life now and then."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from typing import Any

from starlette.responses import Response
from starlette.types import Receive, Scope, Send

from agent.web.live import Page

HEARTBEAT = 10.0
"""Longest silence, s: a browser whose stream is silent for longer knows that the connection is lost."""


class EventStream(Response):
    """Sends each change of a page as an event; ends with the page or when the client is gone."""

    media_type = "text/event-stream"

    def __init__(self, page: Page[Any], gone: Callable[[], None], heartbeat: float = HEARTBEAT) -> None:
        """Make it.

        Args:
            page: Where changes come from.
            gone: Called at the end, whatever ended it.
            heartbeat: Longest silence, s.
        """
        super().__init__(headers={"Cache-Control": "no-store", "X-Accel-Buffering": "no"})
        del self.headers["content-length"]
        self._page = page
        self._gone = gone
        self._heartbeat = heartbeat

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:  # noqa: ARG002 - ASGI
        """Answer the request."""
        left = asyncio.create_task(_disconnected(receive), name="event stream: client")
        try:
            await send({"type": "http.response.start", "status": 200, "headers": self.raw_headers})
            await self._send_all(send, left)
        finally:
            left.cancel()
            self._gone()
            await asyncio.wait({left})

    async def _send_all(self, send: Send, left: asyncio.Task[None]) -> None:
        upcoming = asyncio.create_task(self._page.next(), name="event stream: next")
        try:
            while True:
                done, _ = await asyncio.wait(
                    {left, upcoming}, timeout=self._heartbeat, return_when=asyncio.FIRST_COMPLETED
                )
                if left in done:
                    return
                if upcoming not in done:
                    await send(_body(": alive\n\n"))
                    continue
                change = upcoming.result()
                if change is None:
                    await send({"type": "http.response.body", "body": b"", "more_body": False})
                    return
                upcoming = asyncio.create_task(self._page.next(), name="event stream: next")
                await send(_body(f"data: {change}\n\n"))
        finally:
            upcoming.cancel()
            await asyncio.wait({upcoming})


def _body(text: str) -> dict[str, Any]:
    return {"type": "http.response.body", "body": text.encode(), "more_body": True}


async def _disconnected(receive: Receive) -> None:
    while (await receive())["type"] != "http.disconnect":
        pass
