"""Entries of a message: the objects in which a gateway gives each tag's value, its time and its quality.

As gateways publish them: a list with an object for each tag that changed (Kepware, Neuron, Telegraf), or an
object whose keys are the tags (OPC UA PubSub).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from connectors.base import LoopRole
from connectors.mqtt.messages.malformed import JsonTree, MissingFieldError
from connectors.mqtt.messages.payload import field, text_of
from connectors.mqtt.options import MqttTag

Group = tuple[str | None, tuple[str, ...]]
"""Path of the entries, and of what says whose an entry is."""
Key = tuple[str | None, ...]
"""What stands there."""
ITSELF = "."
"""Path of a message that is the list of entries itself."""


class EntryIndex:
    """Whose entries the messages of one topic have: found by entry, for a message has few of many tags."""

    def __init__(self, tags: Mapping[LoopRole, MqttTag]) -> None:
        self._groups: dict[Group, dict[Key, list[LoopRole]]] = {}
        for name, tag in tags.items():
            if tag.in_entries:
                paths = tuple(sorted(tag.where))
                key = tuple(text_of(tag.where[path]) for path in paths)
                self._groups.setdefault((tag.entry, paths), {}).setdefault(key, []).append(name)

    def __len__(self) -> int:
        """Return how many kinds of entries there are."""
        return len(self._groups)

    def of(self, tree: JsonTree) -> Iterator[tuple[LoopRole, JsonTree]]:
        """Yield each entry of a message with the tag that it is of, in the order of the message."""
        for (path, keys), names in self._groups.items():
            for entry in _entries(tree, path):
                try:
                    key = tuple(text_of(field(entry, each)) for each in keys)
                except MissingFieldError:
                    continue  # an entry of another kind
                for name in names.get(key, ()):
                    yield name, entry


def _entries(tree: JsonTree, path: str | None) -> list[JsonTree]:
    try:
        there = tree if path in {None, ITSELF} else field(tree, str(path))
    except MissingFieldError:
        return []
    return there if isinstance(there, list) else [there]
