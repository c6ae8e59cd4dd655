"""Entries of a message: the objects in which a gateway gives each tag's value, its time and its quality.

As gateways publish them: a list with an object for each tag that changed (Kepware, Neuron, Telegraf), or an
object whose keys are the tags (OPC UA PubSub).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from connectors.mqtt.options import MqttTag
from connectors.mqtt.payload import JsonTree, MissingFieldError, field, text_of

Group = tuple[str | None, tuple[str, ...]]
"""Path of the entries, and of what says whose an entry is."""
ITSELF = "."
"""Path of a message that is the list of entries itself."""
Key = tuple[str | None, ...]
"""What stands there."""


def group_of(tag: MqttTag) -> Group:
    """Return what tags have in common whose entries are found in one pass."""
    return tag.entry, tuple(sorted(tag.where))


def key_of(tag: MqttTag) -> Key:
    """Return what the entries of a tag have at the paths of its group."""
    return tuple(text_of(tag.where[path]) for path in sorted(tag.where))


class Entries:
    """All entries of one message, found by tag."""

    def __init__(self, tree: JsonTree, groups: Iterable[Group]) -> None:
        self._tree = tree
        self._found = {group: _by_key(tree, group) for group in groups}

    def of(self, tag: MqttTag) -> list[JsonTree]:
        """Return the entries of a tag, in the order of the message; none where it says nothing of the tag."""
        if not tag.in_entries:
            return [self._tree]
        return self._found[group_of(tag)].get(key_of(tag), [])


def _by_key(tree: JsonTree, group: Group) -> Mapping[Key, list[JsonTree]]:
    """Return each key -> the entries that have it."""
    path, keys = group
    try:
        there = tree if path in {None, ITSELF} else field(tree, str(path))
    except MissingFieldError:
        return {}
    found: dict[Key, list[JsonTree]] = {}
    for entry in there if isinstance(there, list) else [there]:
        try:
            found.setdefault(tuple(text_of(field(entry, key)) for key in keys), []).append(entry)
        except MissingFieldError:
            continue  # an entry of another kind
    return found
