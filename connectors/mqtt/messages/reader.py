"""Messages become samples; what cannot be read becomes a missing value, and is counted.

A message that has all of its loops, with one time, becomes readings: one piece for as many values as it has.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import chain

import numpy as np

from connectors.base import LoopRole, Quality, Sample
from connectors.mqtt.messages.entries import EntryIndex
from connectors.mqtt.messages.malformed import JsonTree, MalformedPayloadError, MissingFieldError
from connectors.mqtt.messages.payload import bare, field, number, parse, seconds, text_of, value
from connectors.mqtt.messages.quality import quality
from connectors.mqtt.options import MqttTag
from connectors.mqtt.topics import MqttLoops
from connectors.readings import Readings

MOST_SAID = 40
"""Characters of what a message says that are shown to people."""


def readers_of(loops: MqttLoops) -> dict[str, TopicReader]:
    """Return topic -> what reads the messages there."""
    tags: dict[str, dict[LoopRole, MqttTag]] = {}
    for name, loop in loops.items():
        for role, tag in loop.tags.items():
            tags.setdefault(tag.topic, {})[LoopRole(name, role)] = tag
    return {topic: TopicReader(each, whole=_whole(each, loops)) for topic, each in tags.items()}


def _whole(tags: Mapping[LoopRole, MqttTag], loops: MqttLoops) -> bool:
    """Return whether all tags of the loops are among these: others of a loop may come before or after."""
    named = {name.loop for name in tags}
    return sum(len(loops[loop].tags) for loop in named) == len(tags)


@dataclass(frozen=True, slots=True)
class EntrySaid:
    """Where a message says something of a tag."""

    entry: JsonTree
    tree: JsonTree
    """The whole message."""
    payload: bytes

    def time(self, path: str) -> float:
        """Return the source time, s UTC, of the entry, else of the message; raises MalformedError."""
        try:
            return seconds(field(self.entry, path))
        except MissingFieldError:
            return seconds(field(self.tree, path))

    def value(self, name: LoopRole, tag: MqttTag) -> float | str:
        """Return the value, text for modes alone; raises MalformedError."""
        said = bare(self.payload) if tag.field is None else value(field(self.entry, tag.field))
        if isinstance(said, str) and name.role != "mode":
            raise MalformedPayloadError(f"the text {said[:MOST_SAID]!r} where a number belongs")
        return said


class TopicReader:
    """All tags that one topic carries."""

    def __init__(self, tags: Mapping[LoopRole, MqttTag], *, whole: bool = False) -> None:
        """Make it for tags; ``whole``: their loops have no others."""
        self._tags = tags
        self._names = tuple(tags)
        self._fields = tuple(tag.field for tag in tags.values())
        self._time_field = next((tag.time_field for tag in tags.values()), None)
        self._entries = EntryIndex(tags)
        self._whole = tuple(name for name, tag in tags.items() if not tag.in_entries)
        """Those whose value is in the message as a whole."""
        self._good = {name: frozenset(map(str, map(text_of, tag.good))) for name, tag in tags.items()}
        self._is_one_row = (
            whole
            and not self._entries
            and all(
                tag.field is not None and tag.quality_field is None and tag.time_field == self._time_field
                for tag in tags.values()
            )
        )
        """Whether a message can be one piece."""
        self._newest = math.nan
        self.malformed = 0
        """Messages of which some tag could not be read."""

    @property
    def names(self) -> Iterable[LoopRole]:
        """Of the tags."""
        return self._tags

    def readings(self, payload: bytes, arrival: float, *, retained: bool) -> Sequence[Sample] | Readings:
        """Return the same as ``samples``, in one piece where that says all: plain numbers with one time."""
        if not self._is_one_row or (retained and self._time_field is None):
            return self.samples(payload, arrival, retained=retained)
        try:
            tree = parse(payload)
            at = arrival if self._time_field is None else seconds(field(tree, self._time_field))
            values = [number(field(tree, path)) for path in self._fields if path is not None]
        except MalformedPayloadError:
            return self.samples(payload, arrival, retained=retained)
        if self._time_field is not None:
            self._newest = at
        return Readings(self._names, at, np.array(values))

    def samples(self, payload: bytes, arrival: float, *, retained: bool) -> Sequence[Sample]:
        """Return one sample for each tag, or one for each of its entries.

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
        for name, entry in chain(((name, tree) for name in self._whole), self._entries.of(tree)):
            tag = self._tags[name]
            try:
                said = EntrySaid(entry, tree, payload)
                samples.append(self._sample(name, tag, said, arrival, retained=retained))
            except MalformedPayloadError as error:
                if isinstance(error, MissingFieldError) and tag.absent == "unchanged":
                    continue
                samples.append(self._unreadable(name, tag, arrival, error))
                intact = False
        self.malformed += not intact
        return samples

    def _sample(
        self, name: LoopRole, tag: MqttTag, found: EntrySaid, arrival: float, *, retained: bool
    ) -> Sample:
        said = None if tag.quality_field is None else _if_there(found.entry, tag.quality_field)
        worth = quality(said, self._good[name])
        why = "" if worth is Quality.GOOD else f"its quality is {json.dumps(said)[:MOST_SAID]}"
        if tag.time_field is None:
            at, worth = arrival, max(worth, Quality.UNCERTAIN if retained else Quality.GOOD)
        else:
            at = self._newest = found.time(tag.time_field)
        return Sample.measured(name, at, found.value(name, tag), worth, why=why)

    def _unreadable(
        self, name: LoopRole, tag: MqttTag, arrival: float, error: MalformedPayloadError
    ) -> Sample:
        return Sample.missing(name, self._fallback(tag, arrival), why=f"the message has {error}")

    def _fallback(self, tag: MqttTag, arrival: float) -> float:
        return arrival if tag.time_field is None or math.isnan(self._newest) else self._newest


def _if_there(tree: JsonTree, path: str) -> JsonTree:
    try:
        return field(tree, path)
    except MissingFieldError:
        return None
