"""Messages that wait to be read: bounded, each topic for itself, and what is lost is counted."""

from __future__ import annotations

import asyncio
import logging
from collections import Counter

from aiomqtt import Message

_LOG = logging.getLogger(__name__)
_MOST_LOGGED = 100
"""Topics whose first loss is logged; a broker may have any number of them."""


class Losses:
    """What one connection lost, over all its sessions."""

    def __init__(self) -> None:
        self.count = 0
        """Messages that were discarded because too many waited."""
        self._logged: set[str] = set()

    def note(self, topic: str) -> None:
        """Count a message that is discarded; the first of its topic is logged."""
        self.count += 1
        if topic not in self._logged and len(self._logged) < _MOST_LOGGED:
            self._logged.add(topic)
            _LOG.warning("topic %s: messages are discarded, they come faster than they are read", topic)


class Inbox(asyncio.Queue[Message]):
    """Messages in the order in which they came; a topic may hold as many places as it leaves free.

    One flooded topic so takes half of them, and its neighbours have the other half; two take a third each
    (dynamic thresholds: Choudhury and Hahne, IEEE/ACM Trans. Networking 6(2), 1998, with alpha = 1).
    """

    def __init__(self, maxsize: int = 0, losses: Losses | None = None) -> None:
        """Make an empty one for ``maxsize`` messages, which counts in ``losses``."""
        super().__init__(maxsize)
        self._losses = losses or Losses()
        self._held: Counter[str] = Counter()

    def put_nowait(self, item: Message) -> None:
        """Keep a message, or discard it and count that."""
        topic = item.topic.value
        if self._held[topic] >= max(self.maxsize - self.qsize(), 1) or self.full():
            self._losses.note(topic)
            return
        self._held[topic] += 1
        super().put_nowait(item)

    def _get(self) -> Message:
        item = super()._get()
        self._held[item.topic.value] -= 1
        if not self._held[item.topic.value]:
            del self._held[item.topic.value]
        return item
