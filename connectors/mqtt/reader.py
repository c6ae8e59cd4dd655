"""Messages become samples; what cannot be read becomes a missing value, and is counted."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence

from connectors.base import LoopRole, Quality, Sample
from connectors.mqtt.options import MqttTag
from connectors.mqtt.payload import JsonTree, MalformedPayloadError, bare, field, parse, seconds, value
from connectors.mqtt.topics import MqttLoops


def readers_of(loops: MqttLoops) -> dict[str, TopicReader]:
    """Return topic -> what reads the messages there."""
    tags: dict[str, dict[LoopRole, MqttTag]] = {}
    for name, loop in loops.items():
        for role, tag in loop.tags.items():
            tags.setdefault(tag.topic, {})[LoopRole(name, role)] = tag
    return {topic: TopicReader(each) for topic, each in tags.items()}


class TopicReader:
    """All tags that one topic carries."""

    def __init__(self, tags: Mapping[LoopRole, MqttTag]) -> None:
        self._tags = tags
        self._newest = math.nan
        self.malformed = 0
        """Messages of which some tag could not be read."""

    @property
    def names(self) -> Iterable[LoopRole]:
        """Of the tags."""
        return self._tags

    def samples(self, payload: bytes, arrival: float, *, retained: bool) -> Sequence[Sample]:
        """Return one sample for each tag.

        A tag without a source time gets ``arrival`` (s UTC); if the broker had kept the message, nobody knows
        how old it is, and its quality is uncertain. Where the source time cannot be read, the newest is
        taken. An empty payload only takes a kept message back.
        """
        if not payload:
            return []
        try:
            tree = parse(payload) if any(tag.field for tag in self._tags.values()) else None
        except MalformedPayloadError as error:
            self.malformed += 1
            return [self._unreadable(name, tag, arrival, error) for name, tag in self._tags.items()]
        samples = []
        intact = True
        for name, tag in self._tags.items():
            try:
                samples.append(self._sample(name, tag, tree, payload, arrival, retained=retained))
            except MalformedPayloadError as error:
                samples.append(self._unreadable(name, tag, arrival, error))
                intact = False
        self.malformed += not intact
        return samples

    def _sample(
        self, name: LoopRole, tag: MqttTag, tree: JsonTree, payload: bytes, arrival: float, *, retained: bool
    ) -> Sample:
        at, quality = arrival, Quality.UNCERTAIN if retained else Quality.GOOD
        if tag.time_field is not None:
            at, quality = seconds(field(tree, tag.time_field)), Quality.GOOD
            self._newest = at
        found = bare(payload) if tag.field is None else value(field(tree, tag.field))
        if isinstance(found, str) and name.role != "mode":
            raise MalformedPayloadError(f"the text {found[:40]!r} where a number belongs")
        return Sample.measured(name, at, found, quality)

    def _unreadable(
        self, name: LoopRole, tag: MqttTag, arrival: float, error: MalformedPayloadError
    ) -> Sample:
        return Sample.missing(name, self._fallback(tag, arrival), why=f"the message has {error}")

    def _fallback(self, tag: MqttTag, arrival: float) -> float:
        return arrival if tag.time_field is None or math.isnan(self._newest) else self._newest
