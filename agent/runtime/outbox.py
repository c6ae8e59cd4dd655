"""What waits to be told on one connection."""

from __future__ import annotations

import asyncio
from collections import OrderedDict
from typing import Protocol

from connectors.base import Publication


class Outbox(Protocol):
    """Keeps publications in order until the peer took them."""

    def put(self, publication: Publication) -> None:
        """Take one more."""
        ...

    async def first(self) -> Publication:
        """Wait for the one that is due first; it stays until it is removed."""
        ...

    def remove(self, publication: Publication) -> None:
        """Forget it: the peer took it, or never will."""
        ...


class MemoryOutbox:
    """An outbox in memory. What it holds is lost when the process ends.

    A state replaces the former of the same subject, as only the newest matters. Where there are too many
    events, the oldest goes.
    """

    def __init__(self, limit: int = 1000) -> None:
        self._limit = limit
        self._waiting: OrderedDict[tuple[str, str], Publication] = OrderedDict()
        self._filled = asyncio.Event()
        self.dropped = 0
        """Publications that were never told, because there were too many."""

    def __len__(self) -> int:
        return len(self._waiting)

    def put(self, publication: Publication) -> None:
        """Take one more."""
        key = _key(publication)
        self._waiting.pop(key, None)
        self._waiting[key] = publication
        if len(self._waiting) > self._limit:
            self._waiting.popitem(last=False)
            self.dropped += 1
        self._filled.set()

    async def first(self) -> Publication:
        """Wait for the oldest."""
        await self._filled.wait()
        return next(iter(self._waiting.values()))

    def remove(self, publication: Publication) -> None:
        """Forget it, unless a newer one has taken its place meanwhile."""
        key = _key(publication)
        if self._waiting.get(key) == publication:
            del self._waiting[key]
        if not self._waiting:
            self._filled.clear()


def _key(publication: Publication) -> tuple[str, str]:
    if publication.kind == "state":
        return ("state", publication.subject)
    return (publication.kind, publication.id)
