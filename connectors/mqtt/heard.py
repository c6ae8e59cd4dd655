"""Hears for some time what is published on a broker, within bounds; publishes nothing."""

from __future__ import annotations

import asyncio
import contextlib
import time
from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from connectors.base import ConnectionLostError
from connectors.cancellation import obey_cancellation
from connectors.mqtt.client import as_connection_lost, connected, subscribe
from connectors.mqtt.options import Broker

KEPT = 50
"""Newest messages of a topic that are kept: a gateway that publishes changes has its tags in many."""
MOST_BYTES = 100_000_000
"""Of all messages that are kept, about as many as a broker of 10,000 loops has in one minute."""
STEP = 0.2
"""s between two reports of progress."""


@dataclass(frozen=True, slots=True)
class Heard:
    """What was published."""

    messages: Mapping[str, tuple[bytes, ...]]
    """Topic -> its newest payloads, the oldest first."""
    stopped: str | None
    """The bound that ended it, but for time; None where none did."""


async def hear(
    options: Broker,
    topics: str,
    seconds: float,
    most_topics: int,
    progress: Callable[[float], None] = lambda _seconds: None,
) -> Heard:
    """Return what is published; raises ConnectionLostError, also where the broker refuses the topics.

    Args:
        options: The broker.
        topics: Filter with wildcards, as ``plant/#``.
        seconds: How long.
        most_topics: Topics after which it ends.
        progress: Called now and then with the s that have passed.
    """
    ears = _Ears(most_topics)
    async with connected(options) as client:
        if await subscribe(client, [topics]):
            raise ConnectionLostError(f"the broker refuses topic {topics}")
        begin = shown = time.monotonic()
        with as_connection_lost(), contextlib.suppress(TimeoutError):
            async with asyncio.timeout(seconds):
                async for message in client.received():
                    obey_cancellation()
                    ears.take(message.topic.value, bytes(message.payload))
                    if ears.stopped is not None:
                        break
                    if time.monotonic() - shown > STEP:
                        shown = time.monotonic()
                        progress(shown - begin)
    return Heard({topic: tuple(own) for topic, own in ears.kept.items()}, ears.stopped)


class _Ears:
    """What was heard so far."""

    def __init__(self, most_topics: int) -> None:
        self._most_topics = most_topics
        self._size = 0
        self.kept: dict[str, deque[bytes]] = {}
        self.stopped: str | None = None

    def take(self, topic: str, payload: bytes) -> None:
        own = self.kept.setdefault(topic, deque())
        own.append(payload)
        self._size += len(payload) - (len(own.popleft()) if len(own) > KEPT else 0)
        if len(self.kept) > self._most_topics:
            self.stopped = f"{self._most_topics} topics"
        elif self._size > MOST_BYTES:
            self.stopped = f"{MOST_BYTES / 1e6:g} MB"
