"""Publications out of bytes that a broker sent: what nearly all packets of a plant are (MQTT 5, 3.3)."""

from __future__ import annotations

from typing import NamedTuple

from aiomqtt import Message, Topic

_PUBLISH = 0x30
_MOST_TOPICS = 100_000
"""Topics that are remembered; a broker may have any number of them."""
_LONGEST_LENGTH = 4
"""Bytes that the length of a packet takes at most."""


class PlainPublication(NamedTuple):
    """One message and what it takes to go on."""

    message: Message
    end: int
    """Place of the first byte behind it."""


class Publications:
    """Reads those of QoS 0 and 1 without properties that are there in full.

    paho makes an object of MQTT 5 with all its tables, an object of its own and one of aiomqtt for each, and
    checks each topic anew. What is not plain here is left to paho, what is malformed too.
    """

    def __init__(self, *, speaks_5: bool) -> None:
        self._speaks_5 = speaks_5
        self._topics: dict[bytes, Topic] = {}

    def read(self, held: bytes, at: int) -> PlainPublication | None:
        """Return the publication that begins at a place of ``held``; None where paho has to read it."""
        qos, (place, end) = held[at] >> 1 & 3, _content(held, at + 1)
        if held[at] & 0xF0 != _PUBLISH or qos > 1 or end < place + 2 or end > len(held):
            return None
        topic_end = place + 2 + (held[place] << 8 | held[place + 1])
        payload = topic_end + 2 * qos + self._speaks_5
        if payload > end or (self._speaks_5 and held[payload - 1]):  # it has properties
            return None
        topic = self._topic(held[place + 2 : topic_end])
        if topic is None:
            return None
        number = held[topic_end] << 8 | held[topic_end + 1] if qos else 0
        return PlainPublication(
            Message(topic, held[payload:end], qos, bool(held[at] & 1), number, properties=None), end
        )

    def _topic(self, name: bytes) -> Topic | None:
        known = self._topics.get(name)
        if known is None:
            try:
                known = Topic(name.decode())
            except ValueError:
                return None  # no UTF-8, empty, or with a wildcard
            if len(self._topics) >= _MOST_TOPICS:
                self._topics.clear()
            self._topics[name] = known
        return known


def _content(held: bytes, place: int) -> tuple[int, int]:
    """Return where the content of a packet begins and ends, whose length is at a place; (0, 0): not there."""
    length = 0
    for shift, digit in enumerate(held[place : place + _LONGEST_LENGTH]):
        length |= (digit & 0x7F) << 7 * shift
        if digit < 0x80:
            return place + shift + 1, place + shift + 1 + length
    return 0, 0
