"""Publications that a peer refused, kept apart so that they neither block others nor are lost."""

from __future__ import annotations

import asyncio
import logging
import math
from collections import OrderedDict
from dataclasses import dataclass, replace

from agent.runtime.store.change import Change
from agent.runtime.store.journal import Journal
from connectors.base import Publication, RefusedError

LOG = logging.getLogger(__name__)
RETRY = 30.0
"""s from one attempt to the next: a missing node usually appears with a restart of its server."""
HANG_UPS = 3
"""Sessions in a row that end with the same publication, from which the peer is taken to hang up on it."""
HUNG_UP_RETRY, LONGEST_RETRY = 60.0, 3600.0
"""s to the first further attempt, doubled with each: every one may cost a session of all loops."""
LIMIT = 1000
REASONS = 5


HUNG_UP = RefusedError("the peer ends the connection at this publication; perhaps it may not be published")


@dataclass(frozen=True, slots=True)
class Refusal:
    """One publication that was refused, in whole or in part."""

    sequence: int
    """Its number in the store."""
    publication: Publication
    problem: str
    due: float
    """Time of the next attempt, s of the event loop's clock."""
    hang_ups: int = 0
    """Attempts after it was set aside at which the peer hung up."""


class Refusals:
    """Publications that one connection refused. A newer state of a subject replaces the previous one.

    They stay in the store until they are accepted; after a restart they wait in the outbox like all others.
    """

    def __init__(self, connection: str, journal: Journal) -> None:
        self.count = 0
        """Attempts that were refused."""
        self.dropped = 0
        """Publications that were discarded because there were too many."""
        self._connection = connection
        self._journal = journal
        self._waiting: OrderedDict[tuple[str, str], Refusal] = OrderedDict()

    def __len__(self) -> int:
        return len(self._waiting)

    @property
    def due(self) -> float | None:
        """Time of the next attempt, s of the event loop's clock; None if nothing waits."""
        return min((refusal.due for refusal in self._waiting.values()), default=None)

    @property
    def oldest(self) -> int | None:
        """Least sequence number; None if nothing waits."""
        return min((refusal.sequence for refusal in self._waiting.values()), default=None)

    @property
    def reasons(self) -> tuple[str, ...]:
        """What the peer said of those that wait, each once, at most ``REASONS``."""
        return tuple(dict.fromkeys(refusal.problem for refusal in self._waiting.values()))[:REASONS]

    def next(self) -> Publication:
        """Return the publication that is due first."""
        return min(self._waiting.values(), key=lambda refusal: refusal.due).publication

    def add(self, sequence: int, publication: Publication, error: RefusedError) -> None:
        """Keep a publication for a later attempt; logged if it is new here or the reason is new."""
        former = self._waiting.pop(publication.key, None)
        if former is None or former.problem != str(error):
            LOG.warning(
                "connection %s refused a publication about %s: %s",
                self._connection,
                publication.subject,
                error,
                extra={"event": "refused", "connection": self._connection, "loop": publication.subject},
            )
        if former is not None and former.sequence != sequence:
            self._forget(former)
        due = asyncio.get_running_loop().time() + RETRY
        self._waiting[publication.key] = Refusal(sequence, publication, str(error), due)
        if len(self._waiting) > LIMIT:
            oldest = self._waiting.popitem(last=False)[1]
            self._forget(oldest)
            self._try_the_others(oldest.publication)
            self.dropped += 1

    def again(self, publication: Publication, error: RefusedError) -> None:
        """Keep a publication whose repeated attempt failed."""
        former = self._waiting.get(publication.key)
        if former is not None and former.publication.id == publication.id:
            self.add(former.sequence, publication, error)

    def hung_up(self, publication: Publication, sequence: int | None = None) -> None:
        """Keep a publication on which the peer hangs up, for later and later attempts.

        ``sequence``: its number in the store where it is new here; None: it is here.
        """
        former = self._waiting.get(publication.key)
        if sequence is None and (former is None or former.publication.id != publication.id):
            return
        hang_ups = 0 if former is None else former.hang_ups + 1
        self.add(former.sequence if sequence is None and former else sequence or 0, publication, HUNG_UP)
        due = asyncio.get_running_loop().time() + min(HUNG_UP_RETRY * 2 ** min(hang_ups, 10), LONGEST_RETRY)
        self._waiting[publication.key] = replace(self._waiting[publication.key], due=due, hang_ups=hang_ups)

    def hangs_up_at(self, publication: Publication) -> bool:
        """Whether the peer is known to hang up at publications of this kind and subject."""
        return self._waiting_of(publication) is not None

    def add_beside(self, sequence: int, publication: Publication) -> None:
        """Keep one of which the topic is known to end sessions; it is tried when another of it was accepted.

        One that replaces the former takes over when that is tried.
        """
        former = self._waiting_of(publication)
        replaces = former is not None and former.publication.key == publication.key
        self.add(sequence, publication, HUNG_UP)
        due, hang_ups = (former.due, former.hang_ups) if former is not None and replaces else (math.inf, 0)
        self._waiting[publication.key] = replace(self._waiting[publication.key], due=due, hang_ups=hang_ups)

    def _waiting_of(self, publication: Publication) -> Refusal | None:
        """Return the one of this kind and subject that is tried next, where the peer hangs up there."""
        topic = publication.kind, publication.subject
        known = [
            each
            for each in self._waiting.values()
            if each.problem == str(HUNG_UP) and (each.publication.kind, each.publication.subject) == topic
        ]
        return min(known, key=lambda each: each.due, default=None)

    def _try_the_others(self, publication: Publication) -> None:
        """Try what waited beside one of its kind and subject that is settled or gone."""
        now = asyncio.get_running_loop().time()
        for key, each in self._waiting.items():
            if math.isinf(each.due) and (each.publication.kind, each.publication.subject) == (
                publication.kind,
                publication.subject,
            ):
                self._waiting[key] = replace(each, due=now)

    def settle(self, publication: Publication) -> None:
        """Remove it: the peer accepted it, or a newer one."""
        refusal = self._waiting.pop(publication.key, None)
        if refusal is not None:
            self._forget(refusal)
            self._try_the_others(publication)
            LOG.info(
                "connection %s accepts publications about %s again",
                self._connection,
                publication.subject,
                extra={"event": "taken", "connection": self._connection, "loop": publication.subject},
            )

    def emptied(self) -> dict[int, Publication]:
        """Remove and return all that wait: sequence number -> publication."""
        waiting = {refusal.sequence: refusal.publication for refusal in self._waiting.values()}
        self._waiting.clear()
        return waiting

    def _forget(self, refusal: Refusal) -> None:
        self._journal.note(Change(removed=frozenset({refusal.sequence})))
