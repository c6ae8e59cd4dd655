"""The edge node as Sparkplug sees it: births, data, death, and the numbers that tie them together; no I/O.

Source: Sparkplug 3.0.0, sections 4 (topics), 5 (what follows what) and 6.4 (payloads).
"""

from __future__ import annotations

from collections.abc import Mapping

from connectors.base import WITHDRAWN, JsonValue, Publication
from connectors.mqtt.client import Outgoing
from connectors.sparkplug.metrics import (
    ABOUT_THE_MESSAGE,
    BD_SEQ,
    METRICS,
    REBIRTH,
    Reported,
    commands_at_rest,
    values_of,
)
from connectors.sparkplug.payload import CONTENT, DataType, Metric, encode

NAMESPACE = "spBv1.0"
WRAP = 256
"""Both sequences count from 0 to 255."""


class EdgeNode:
    """What is published, and how far the sequences are. Send what its methods return, in that order."""

    def __init__(self, group: str, node: str, devices: Mapping[str, str], *, writable: bool) -> None:
        """Make one that is not connected yet.

        Args:
            group: Group id.
            node: Edge node id.
            devices: Subject -> device id.
            writable: Whether a host may write the metrics of commands.
        """
        self.devices = devices
        self.subjects = {device: subject for subject, device in devices.items()}
        self._group = group
        self._node = node
        self._writable = writable
        self._bd_seq = -1
        self._seq = 0
        self._reported: dict[str, dict[str, Reported]] = {subject: {} for subject in devices}

    def topic(self, verb: str, device: str | None = None) -> str:
        """Return the topic of a message."""
        parts = (NAMESPACE, self._group, verb, self._node)
        return "/".join(parts if device is None else (*parts, device))

    def will(self, now: float) -> Outgoing:
        """Return the last will of the next connection, with which its number rises."""
        self._bd_seq = (self._bd_seq + 1) % WRAP
        return self.death(now)

    def death(self, now: float) -> Outgoing:
        """Return what ends this connection; it has no place in the sequence."""
        bd_seq = Metric(BD_SEQ, self._bd_seq, DataType.INT64, now)
        return Outgoing(self.topic("NDEATH"), encode([bd_seq], now), content=CONTENT)

    def births(self, now: float) -> list[Outgoing]:
        """Return what a host must know before any data: the node and all devices, each with every metric."""
        self._seq = -1
        node = [
            Metric(BD_SEQ, self._bd_seq, DataType.INT64, now),
            Metric(REBIRTH, value=False, type=DataType.BOOLEAN, time=now),
        ]
        messages = [self._numbered("NBIRTH", None, node, now)]
        for subject, device in self.devices.items():
            known = self._reported[subject]
            unknown = Reported(None, now)
            metrics = [
                Metric(name, known.get(name, unknown).value, kind, known.get(name, unknown).time)
                for name, kind in METRICS.items()
            ]
            if self._writable:
                metrics += commands_at_rest(now)
            messages.append(self._numbered("DBIRTH", device, metrics, now))
        return messages

    def data(self, publication: Publication, now: float) -> Outgoing | None:
        """Return what has changed with a publication; None where there is nothing to publish.

        The state of a change comes first, so that its event mostly has nothing to add. An event that
        is late has all its values, marked as history: newer ones were published already.
        """
        subject, fields = publication.subject, publication.fields
        if subject not in self.devices or publication.kind == WITHDRAWN:  # the next birth will not have it
            return None
        at = fields.get("time")
        time = float(at) if isinstance(at, int | float) else now
        values = values_of(fields)
        historical = bool(fields.get("historical"))
        if not historical:
            known = self._reported[subject]
            values = {name: each for name, each in values.items() if _is_news(known.get(name), each)}
            if publication.kind == "event" and values.keys() <= ABOUT_THE_MESSAGE:
                return None
            known |= {name: Reported(each, time) for name, each in values.items()}
        if not values:
            return None
        metrics = [Metric(name, each, METRICS[name], time, historical) for name, each in values.items()]
        return self._numbered("DDATA", self.devices[subject], metrics, now)

    def _numbered(self, verb: str, device: str | None, metrics: list[Metric], now: float) -> Outgoing:
        self._seq = (self._seq + 1) % WRAP
        return Outgoing(self.topic(verb, device), encode(metrics, now, self._seq), qos=0, content=CONTENT)


def _is_news(known: Reported | None, value: JsonValue) -> bool:
    return known is None or known.value != value
