"""What waits to be told on one connection."""

from __future__ import annotations

import asyncio
import logging
from collections import OrderedDict
from collections.abc import Mapping
from dataclasses import dataclass, replace

from agent.runtime.change import Change, Waiting
from agent.runtime.journal import Journal
from connectors.base import Publication

LOG = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True)
class _Entry:
    sequence: int
    publication: Publication
    late: bool
    """Whether the connection was gone when it came, or while it waited."""


class Outbox:
    """Keeps publications in order until the peer took them, on disk where the journal has a store.

    A state replaces the former of the same subject, as only the newest matters. Where there are too many, the
    oldest state goes, which the next window tells anew; an event goes only where nothing else is left.
    """

    def __init__(self, target: str, journal: Journal, limit: int = 1000) -> None:
        """Make an empty one.

        Args:
            target: Name of the connection.
            journal: Keeps on disk what waits.
            limit: Most publications that may wait.
        """
        self.dropped = 0
        """Publications that were never told, because there were too many."""
        self._target = target
        self._journal = journal
        self._limit = limit
        self._waiting: OrderedDict[tuple[str, str], _Entry] = OrderedDict()
        self._filled = asyncio.Event()
        self._connected = False

    def __len__(self) -> int:
        return len(self._waiting)

    def restore(self, kept: Mapping[int, Publication]) -> None:
        """Take what the store kept: sequence number -> publication, ascending."""
        for sequence, publication in kept.items():
            self._waiting[_key(publication)] = _Entry(sequence, publication, late=True)
            self._filled.set()

    def put(self, publication: Publication) -> None:
        """Take one more; the next flush of the journal writes it."""
        key, sequence = _key(publication), self._journal.next_sequence()
        former = self._waiting.pop(key, None)
        self._waiting[key] = _Entry(sequence, publication, late=not self._connected)
        self._journal.note(
            Change(
                put={sequence: Waiting(self._target, publication)},
                removed=frozenset() if former is None else frozenset({former.sequence}),
            )
        )
        if len(self._waiting) > self._limit:
            self._drop()
        self._filled.set()

    async def first(self) -> Publication:
        """Wait for the oldest, as it should be sent now; nothing is sent before it is on disk.

        It stays until it is removed.
        """
        self._connected = True
        await self._journal.flush()
        while True:
            await self._filled.wait()
            entry = next(iter(self._waiting.values()))
            await self._journal.flush()
            if entry in self._waiting.values():
                return _told(entry)

    def remove(self, publication: Publication) -> None:
        """Forget it: the peer took it or never will. One that has taken its place meanwhile stays."""
        entry = self._waiting.get(_key(publication))
        if entry is not None and entry.publication.id == publication.id:
            self._forget(_key(publication))

    def interrupt(self) -> None:
        """The connection is gone: what waits now and comes until it is back is told late."""
        self._connected = False
        for key, entry in self._waiting.items():
            self._waiting[key] = replace(entry, late=True)

    def _drop(self) -> None:
        self.dropped += 1
        states = (key for key in self._waiting if key[0] == "state")
        key = next(states, None) or next(iter(self._waiting))
        if key[0] != "state":
            LOG.error("connection %s: too much waits, %s is never told", self._target, key[1])
        self._forget(key)

    def _forget(self, key: tuple[str, str]) -> None:
        entry = self._waiting.pop(key)
        self._journal.note(Change(removed=frozenset({entry.sequence})))
        if not self._waiting:
            self._filled.clear()


def _key(publication: Publication) -> tuple[str, str]:
    if publication.kind == "state":
        return ("state", publication.subject)
    return (publication.kind, publication.id)


def _told(entry: _Entry) -> Publication:
    """Return what is sent. A state is the newest there is, however late: only events become history."""
    historical = entry.late and entry.publication.kind != "state"
    fields = {**entry.publication.fields, "sequence": entry.sequence, "historical": historical}
    return replace(entry.publication, fields=fields)
