"""Detects hung tasks, and lets systemd restart the daemon then.

The supervisor handles losses. This handles what no supervisor can see: a library that swallows a
cancellation, an attempt that never returns. Each task that waits sets a deadline (``Health.expect``). A hung
event loop needs no check: the sign of life stops then.
"""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Callable
from typing import NoReturn

from agent.runtime.operate.notify import ServiceManager
from connectors.cancellation import obey_cancellation

LOG = logging.getLogger(__name__)
LOOK = 10.0
"""Time between two checks, s; shorter if the service manager requires it."""


async def watch(hung: Callable[[], tuple[str, ...]], manager: ServiceManager) -> NoReturn:
    """Send signs of life while nothing hangs, and log hung tasks."""
    reported: set[str] = set()
    while True:
        now = set(hung())
        for each in sorted(now - reported):
            LOG.error("%s hangs, which is a fault of this program", each, extra={"event": "hung"})
        for each in sorted(reported - now):
            LOG.info("%s has come back", each, extra={"event": "up"})
        reported = now
        if not now:
            manager.alive()
        obey_cancellation()
        await asyncio.sleep(LOOK if manager.watchdog is None else min(manager.watchdog / 3, LOOK))
