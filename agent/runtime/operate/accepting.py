"""Says seldom that no connection can be accepted: asyncio logs it for each try, many times a second."""

from __future__ import annotations

import asyncio
import logging
import math
from typing import Any

LOG = logging.getLogger(__name__)
AGAIN = 60.0
"""Time until it is logged once more, s."""
NO_MORE = "socket.accept() out of system resource"
"""How asyncio's report begins."""


def log_refused_accepts_seldom(loop: asyncio.AbstractEventLoop) -> None:
    """Have the loop log such a report once a minute; all others as always."""
    logged = -math.inf

    def handle(loop: asyncio.AbstractEventLoop, context: dict[str, Any]) -> None:
        nonlocal logged
        if context.get("message") != NO_MORE:
            loop.default_exception_handler(context)
        elif loop.time() - logged >= AGAIN:
            logged = loop.time()
            LOG.error(
                "no more connections can be accepted for now: %s",
                context.get("exception"),
                extra={"event": "full"},
            )

    loop.set_exception_handler(handle)
