"""Withdraws the published alarms of loops that leave the settings: otherwise they would stay for ever."""

from __future__ import annotations

import asyncio
import contextlib
import logging
from collections.abc import Mapping

from agent.runtime.link.connection import Connection
from agent.runtime.link.outbox import Outbox
from agent.settings import Settings, tags_on
from connectors.base import WITHDRAWN, Publication

LOG = logging.getLogger(__name__)
WITHIN = 2.0
"""Longest wait for the peers to take it, s."""
LOOK = 0.01
"""s"""


def leaving(old: Settings, new: Settings) -> list[tuple[str, str]]:
    """Return connection and loop wherever a published loop will be dropped or published elsewhere."""
    left = []
    for name in old.connections:
        after = tags_on(new, name) if name in new.connections else {}
        for loop, tags in tags_on(old, name).items():
            then = after.get(loop)
            same = then is not None and (then.targets, then.variables) == (tags.targets, tags.variables)
            if tags.targets and not same:
                left.append((name, loop))
    return left


async def withdraw(
    places: list[tuple[str, str]],
    connections: Mapping[str, Connection],
    outboxes: Mapping[str, Outbox],
    now: float,
) -> None:
    """Publish withdrawals and return when the peers accepted them; a peer that is slow or down is logged.

    Args:
        places: Connection and loop.
        connections: By name.
        outboxes: By connection.
        now: s UTC.
    """
    waiting = []
    for name, loop in places:
        publication = Publication(loop, WITHDRAWN, f"{loop}/{now:.6f}/{WITHDRAWN}", {"active": False})
        if connections[name].health.up:
            outboxes[name].put(publication)
            waiting.append((name, publication))
        else:
            _left(name, loop)
    with contextlib.suppress(TimeoutError):
        async with asyncio.timeout(WITHIN):
            while any(publication in outboxes[name] for name, publication in waiting):  # noqa: ASYNC110
                await asyncio.sleep(LOOK)
    for name, publication in waiting:
        if publication in outboxes[name]:
            outboxes[name].taken(publication)
            _left(name, publication.subject)


def _left(connection: str, loop: str) -> None:
    LOG.warning("%s: no longer watched, but its alarm stays on connection %s: it is down", loop, connection)
