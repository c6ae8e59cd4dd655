"""Publications that wait for one connection."""

from __future__ import annotations

import asyncio
import logging
from collections import OrderedDict
from collections.abc import Mapping
from dataclasses import dataclass, replace

from agent.runtime.link.refusals import HANG_UPS, Refusals
from agent.runtime.store.change import Change, Waiting
from agent.runtime.store.journal import Journal
from connectors.base import Publication, RefusedError

LOG = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True)
class _Entry:
    sequence: int
    publication: Publication
    late: bool
    """Whether the connection was down when it was queued, or while it waited."""


class Outbox:
    """Keeps publications in order until the peer accepts them, on disk where the journal has a store.

    A state replaces the previous one of the same subject, as only the newest matters. If the outbox is full,
    the oldest state is discarded, since the next window publishes a new one; an event is discarded only if
    there is no state.
    """

    def __init__(self, target: str, journal: Journal, limit: int = 1000) -> None:
        """Make an empty one.

        Args:
            target: Name of the connection.
            journal: Keeps the waiting publications on disk.
            limit: Greatest number of waiting publications.
        """
        self.dropped = 0
        """Publications that were discarded because the outbox was full."""
        self.refusals = Refusals(target, journal)
        """Publications that the peer refused; the others do not wait for them."""
        self._target = target
        self._journal = journal
        self._limit = limit
        self._waiting: OrderedDict[tuple[str, str], _Entry] = OrderedDict()
        self._published: dict[str, Publication] = {}
        self.in_doubt = False
        """Whether the newest session ended with a publication: what was accepted before is sent first."""
        self._hang_ups: dict[tuple[str, str], int] = {}
        """Kind and subject -> sessions that ended with such a publication since one was accepted."""
        self._filled = asyncio.Event()
        self._connected = False

    def __len__(self) -> int:
        return len(self._waiting)

    def __contains__(self, publication: Publication) -> bool:
        """Whether it still waits; a refused publication does not."""
        return self._entry_of(publication) is not None

    @property
    def oldest(self) -> float | None:
        """Time of the oldest publication that the peer has not accepted, s UTC; None if it accepted all."""
        numbers = [entry.sequence for entry in self._waiting.values()]
        if self.refusals.oldest is not None:
            numbers.append(self.refusals.oldest)
        return min(numbers) / 1000 if numbers else None

    def restore(self, kept: Mapping[int, Publication]) -> None:
        """Add the publications from the store: sequence number -> publication, ascending."""
        for sequence, publication in kept.items():
            former = self._waiting.pop(publication.key, None)
            if former is not None:  # a state that had been refused when the next one came
                self._journal.note(Change(removed=frozenset({former.sequence})))
            self._waiting[publication.key] = _Entry(sequence, publication, late=True)
            self._filled.set()

    def put(self, publication: Publication) -> None:
        """Add a publication; the next flush of the journal writes it."""
        key, sequence = publication.key, self._journal.next_sequence()
        former = self._waiting.pop(key, None)
        aside = self.refusals.hangs_up_at(publication)
        if not aside:
            self._waiting[key] = _Entry(sequence, publication, late=not self._connected)
        self._journal.note(
            Change(
                put={sequence: Waiting(self._target, publication)},
                removed=frozenset() if former is None else frozenset({former.sequence}),
            )
        )
        if aside:  # each would cost a session of all loops
            self.refusals.add_beside(sequence, publication)
            return
        if len(self._waiting) > self._limit:
            self._drop()
        self._filled.set()

    async def first(self) -> Publication:
        """Wait for the oldest publication, in the form to send now; nothing is sent before it is on disk.

        It stays in the outbox until it is accepted or refused.
        """
        self._connected = True
        await self._journal.flush()
        while True:
            await self._filled.wait()
            entry = next(iter(self._waiting.values()))
            await self._journal.flush()
            if entry in self._waiting.values():
                return _as_sent(entry)

    def taken(self, publication: Publication) -> None:
        """Remove a publication that the peer accepted. One that has replaced it meanwhile stays."""
        self.in_doubt = False
        self._hang_ups.pop((publication.kind, publication.subject), None)
        if self._entry_of(publication) is not None:
            self._forget(publication.key)
        if publication.kind == "state":
            self._published[publication.subject] = publication
        elif publication.kind != "event":
            self._published.pop(publication.subject, None)
        self.refusals.settle(publication)

    def published(self) -> tuple[Publication, ...]:
        """Return the newest state of each subject that the peer accepted, and that nothing newer follows.

        A peer that was restarted has lost them: they are published again when a session opens.
        """
        return tuple(each for each in self._published.values() if each.key not in self._waiting)

    def stands(self, publication: Publication) -> bool:
        """Whether a state that was accepted is still the newest of its subject."""
        return self._published.get(publication.subject) is publication

    def refused(self, publication: Publication, error: RefusedError) -> None:
        """Set a refused publication aside; one that has replaced it meanwhile comes next."""
        self.refusals.count += 1
        entry = self._entry_of(publication)
        if entry is None:
            self.refusals.again(publication, error)
        else:
            self._pop(publication.key)
            self.refusals.add(entry.sequence, publication, error)

    def hung_up(self, publication: Publication, *, works: bool) -> None:
        """Take note that a session ended while a publication was under way.

        Some brokers end the connection at a topic that may not be published. What is about the same subject
        goes behind the others; after some such sessions that worked otherwise it is set aside.

        Args:
            publication: That was under way.
            works: Whether the peer sent or accepted anything else in this session.
        """
        self.in_doubt = True
        about = [
            key for key, entry in self._waiting.items() if entry.publication.subject == publication.subject
        ]
        for each in about:
            self._waiting.move_to_end(each)
        if not works:
            return
        topic = publication.kind, publication.subject
        self._hang_ups[topic] = self._hang_ups.get(topic, 0) + 1
        entry = self._entry_of(publication)
        if entry is None:
            self.refusals.hung_up(publication)
        elif self._hang_ups[topic] >= HANG_UPS:
            self._pop(publication.key)
            self.refusals.count += 1
            self.refusals.hung_up(publication, entry.sequence)

    def emptied(self) -> dict[int, Publication]:
        """Remove and return all waiting publications, refused or not: sequence number -> publication."""
        waiting = {entry.sequence: entry.publication for entry in self._waiting.values()}
        self._waiting.clear()
        self._filled.clear()
        return waiting | self.refusals.emptied()

    def interrupt(self) -> None:
        """Mark the connection as down: what waits now, or comes until it is back, is published late."""
        self._connected = False
        for key, entry in self._waiting.items():
            self._waiting[key] = replace(entry, late=True)

    def _drop(self) -> None:
        self.dropped += 1
        states = (key for key in self._waiting if key[0] == "state")
        key = next(states, None) or next(iter(self._waiting))
        if key[0] != "state":
            LOG.error(
                "connection %s: outbox full: %s was discarded",
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


def _as_sent(entry: _Entry) -> Publication:
    """Return the publication to send. A state is the newest, however late; only events can be historical."""
    historical = entry.late and entry.publication.kind == "event"
    fields = {**entry.publication.fields, "sequence": entry.sequence, "historical": historical}
    return replace(entry.publication, fields=fields)
