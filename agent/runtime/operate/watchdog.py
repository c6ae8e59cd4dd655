"""Notices work that hangs, and lets systemd start the daemon anew then.

A loss is for the supervisor. This is for what no supervisor can see: a library that keeps a cancellation to
itself, an attempt that never comes back. Whoever waits says until when at the latest (``Health.expect``). A
hanging event loop needs no look at all: nobody sends the sign of life then.
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
"""Time between two looks where no service manager wants them more often, s."""


async def watch(hung: Callable[[], tuple[str, ...]], manager: ServiceManager) -> NoReturn:
    """Send signs of life while nothing hangs, and say what does."""
    told: set[str] = set()
    while True:
        now = set(hung())
        for each in sorted(now - told):
            LOG.error("%s hangs, which is a fault of this program", each, extra={"event": "hung"})
        for each in sorted(told - now):
            LOG.info("%s has come back", each, extra={"event": "up"})
        told = now
        if not now:
            manager.alive()
        obey_cancellation()
        await asyncio.sleep(LOOK if manager.watchdog is None else min(manager.watchdog / 3, LOOK))
