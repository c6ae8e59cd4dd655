"""What waits to be told on one connection."""

from __future__ import annotations

import asyncio
import logging
from collections import OrderedDict
from collections.abc import Mapping
from dataclasses import dataclass, replace

from agent.runtime.link.refusals import Refusals
from agent.runtime.store.change import Change, Waiting
from agent.runtime.store.journal import Journal
from connectors.base import Publication, RefusedError

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
        self.refusals = Refusals(target, journal)
        """What the peer would not take; all else waits no longer behind it."""
        self._target = target
        self._journal = journal
        self._limit = limit
        self._waiting: OrderedDict[tuple[str, str], _Entry] = OrderedDict()
        self._filled = asyncio.Event()
        self._connected = False

    def __len__(self) -> int:
        return len(self._waiting)

    def __contains__(self, publication: Publication) -> bool:
        """Whether it waits still; what was refused does not."""
        return self._entry_of(publication) is not None

    @property
    def oldest(self) -> float | None:
        """When the oldest came that the peer has not taken yet, s UTC; None where it has taken all."""
        numbers = [entry.sequence for entry in self._waiting.values()]
        if self.refusals.oldest is not None:
            numbers.append(self.refusals.oldest)
        return min(numbers) / 1000 if numbers else None

    def restore(self, kept: Mapping[int, Publication]) -> None:
        """Take what the store kept: sequence number -> publication, ascending."""
        for sequence, publication in kept.items():
            former = self._waiting.pop(publication.key, None)
            if former is not None:  # a state that had been refused when the next one came
                self._journal.note(Change(removed=frozenset({former.sequence})))
            self._waiting[publication.key] = _Entry(sequence, publication, late=True)
            self._filled.set()

    def put(self, publication: Publication) -> None:
        """Take one more; the next flush of the journal writes it."""
        key, sequence = publication.key, self._journal.next_sequence()
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

        It stays until it is taken or refused.
        """
        self._connected = True
        await self._journal.flush()
        while True:
            await self._filled.wait()
            entry = next(iter(self._waiting.values()))
            await self._journal.flush()
            if entry in self._waiting.values():
                return _told(entry)

    def taken(self, publication: Publication) -> None:
        """Forget it: the peer took it. One that has taken its place meanwhile stays."""
        if self._entry_of(publication) is not None:
            self._forget(publication.key)
        self.refusals.settle(publication)

    def refused(self, publication: Publication, error: RefusedError) -> None:
        """Put it aside; one that has taken its place meanwhile comes next."""
        self.refusals.count += 1
        entry = self._entry_of(publication)
        if entry is None:
            self.refusals.again(publication, error)
        else:
            self._pop(publication.key)
            self.refusals.add(entry.sequence, publication, error)

    def emptied(self) -> dict[int, Publication]:
        """Give back all that waits, refused or not: sequence number -> publication."""
        waiting = {entry.sequence: entry.publication for entry in self._waiting.values()}
        self._waiting.clear()
        self._filled.clear()
        return waiting | self.refusals.emptied()

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
            LOG.error(
                "connection %s: too much waits, %s is never told",
                self._target,
                key[1],
                extra={"event": "dropped", "connection": self._target},
            )
        self._forget(key)

    def _entry_of(self, publication: Publication) -> _Entry | None:
        entry = self._waiting.get(publication.key)
        return entry if entry is not None and entry.publication.id == publication.id else None

    def _forget(self, key: tuple[str, str]) -> None:
        self._journal.note(Change(removed=frozenset({self._pop(key).sequence})))

    def _pop(self, key: tuple[str, str]) -> _Entry:
        entry = self._waiting.pop(key)
        if not self._waiting:
            self._filled.clear()
        return entry


def _told(entry: _Entry) -> Publication:
    """Return what is sent. A state is the newest there is, however late: only events become history."""
    historical = entry.late and entry.publication.kind == "event"
    fields = {**entry.publication.fields, "sequence": entry.sequence, "historical": historical}
    return replace(entry.publication, fields=fields)
