"""The tags in messages that were heard on a broker: where each value is, with its time and its quality.

A message is an object, a list of objects in it, or a bare value. What says whose an object is, is taken to be
that text in it which names loops, as in exports (decision 151); no list of vendors is needed.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache

from connectors.exports.cells.tag_roles import ROLE, is_time, plain
from connectors.mqtt.messages.entries import ITSELF
from connectors.mqtt.messages.malformed import JsonTree, MalformedPayloadError
from connectors.mqtt.messages.payload import bare, parse

TIMES = frozenset({"sourcetimestamp", "sourcetime", "utc"})
"""Last words of the path of a time, beside those of exports."""
QUALITIES = frozenset({"qc", "isgood"})
"""Of a quality, likewise."""
VALUES = ("v", "value", "val", "d")
"""Last words of the path of a value that is called by what is before it, the surest first."""
SOURCE_TIME = "sourcetimestamp"
"""Of OPC UA, which leaves a good ``StatusCode`` out: it would be beside."""
DEEPEST, MOST_LEAVES = 8, 50_000
"""Levels of a message, and leaves of all messages of a topic, that are looked at."""

Leaves = Mapping[str, str | int | float | bool | None]
"""Path -> scalar of one object."""
Stamps = dict[str, dict[str, str]]
"""Path of an object -> key of a configuration -> path of its time, of its quality."""


@dataclass(frozen=True, slots=True)
class HeardTag:
    """A value that somebody publishes."""

    name: str
    """By which it is known as part of a loop."""
    tag: Mapping[str, object]
    """Its entry in a configuration."""
    value: str | int | float | bool | None
    """The newest."""


def heard_tags(
    topic: str, payloads: Sequence[bytes], loops_of: Callable[[Iterable[str]], int]
) -> list[HeardTag]:
    """Return the tags of one topic.

    Args:
        topic: Where the messages came.
        payloads: The messages, the oldest first.
        loops_of: Returns how many loops names make.
    """
    trees = [tree for each in payloads if (tree := _tree(each)) is not None]
    found = []
    if trees and not isinstance(trees[-1], dict | list):
        found.append(HeardTag(topic, {"topic": topic}, trees[-1]))
    objects = _objects(trees)
    of_message = _stamps(objects.get(None, [{}])[-1]).get("", {})
    time = {key: path for key, path in of_message.items() if key == "time_field"}
    for path, own in objects.items():
        place = {} if path is None else {"entry": path}
        found += _tags_of({"topic": topic, **place}, own, time, loops_of)
    return found


def _tree(payload: bytes) -> JsonTree:
    try:
        return parse(payload)
    except MalformedPayloadError:
        try:
            return bare(payload)
        except MalformedPayloadError:
            return None


def _objects(trees: Iterable[JsonTree]) -> dict[str | None, list[Leaves]]:
    """Return path of a list (None: of the message) -> the objects there, of all messages."""
    found: dict[str | None, list[Leaves]] = {}
    for tree in trees:
        if isinstance(tree, dict):
            found.setdefault(None, []).append(dict(_leaves(tree)))
        for path, listed in _lists(tree):
            for each in listed:
                if isinstance(each, dict):
                    found.setdefault(path, []).append(dict(_leaves(each)))
    return found


def _leaves(tree: JsonTree, path: str = "", depth: int = 0) -> Iterator[tuple[str, str | int | float | None]]:
    """Yield each scalar of nested objects with its path; lists are left out."""
    if isinstance(tree, dict) and depth < DEEPEST:
        for key, inner in tree.items():
            yield from _leaves(inner, f"{path}.{key}" if path else key, depth + 1)
    elif path and not isinstance(tree, dict | list):
        yield path, tree


def _lists(tree: JsonTree, path: str = "", depth: int = 0) -> Iterator[tuple[str, list[JsonTree]]]:
    """Yield the outermost lists with their paths."""
    if isinstance(tree, list):
        yield path or ITSELF, tree
    elif isinstance(tree, dict) and depth < DEEPEST:
        for key, inner in tree.items():
            yield from _lists(inner, f"{path}.{key}" if path else key, depth + 1)


def _tags_of(
    place: Mapping[str, object],
    objects: Sequence[Leaves],
    time: Mapping[str, str],
    loops_of: Callable[[Iterable[str]], int],
) -> list[HeardTag]:
    """Return the tags of objects at one place; ``time`` is that of the message, where it has one."""
    longest = max((len(each) for each in objects), default=0)
    objects = objects[-max(1, MOST_LEAVES // max(1, longest)) :]
    texts: dict[str, list[str]] = {}
    for each in objects:
        for path, value in each.items():
            if isinstance(value, str) and _stamp(path) is None:
                texts.setdefault(path, []).append(value)
    naming = {path: loops_of(map(name_in_id, dict.fromkeys(own))) for path, own in texts.items()}
    best = max(naming, key=lambda path: naming[path], default=None)
    if best is None or not naming[best]:
        return _of_rows(place, objects, time)
    newest = {str(each[best]): each for each in objects if isinstance(each.get(best), str)}
    found = []
    for name, each in newest.items():
        where = _value_in(each)
        if where is not None:
            beside = _beside(where, _stamps(each))
            tag = {**place, "where": {best: name}, "field": where, **time, **beside}
            found.append(HeardTag(name_in_id(name), tag, each[where]))
    return found


def _of_rows(
    place: Mapping[str, object], objects: Sequence[Leaves], time: Mapping[str, str]
) -> list[HeardTag]:
    """Return a tag for each value of objects that hold values of several tags, or of one without a name."""
    newest: dict[str, Leaves] = {path: each for each in objects for path in each}
    seldom = {path for path in newest if any(path not in each for each in objects)}
    stamps = {key: _stamps(each) for key, each in {id(each): each for each in newest.values()}.items()}
    found = []
    for path, each in newest.items():
        if _stamp(path) is not None or "statuscode" in path.casefold().replace("_", ""):
            continue
        name = path.rpartition(".")[0] if _last(path) in VALUES else path
        tag = {**place, "field": path, **time, **_beside(path, stamps[id(each)])}
        tag |= {"absent": "unchanged"} if path in seldom else {}
        found.append(HeardTag(f"{place['topic']}/{name}".strip("/"), tag, each[path]))
    return found


def _value_in(leaves: Leaves) -> str | None:
    """Return the path of the value in an object that is of one tag; None where that is not clear."""
    numbers = [
        path for path, value in leaves.items() if isinstance(value, int | float) and _stamp(path) is None
    ]
    for word in VALUES:
        named = [path for path in leaves if _last(path) == word]
        if named:
            return min(named, key=len)
    return numbers[0] if len(numbers) == 1 else None


def _stamps(leaves: Leaves) -> Stamps:
    """Return path of an object -> its own times and qualities, the first of each."""
    found: Stamps = {}
    for path in leaves:
        key = _stamp(path)
        if key is not None:
            found.setdefault(path.rpartition(".")[0], {}).setdefault(key, path)
    return found


def _beside(path: str, stamps: Stamps) -> dict[str, str]:
    """Return where time and quality of a value are: beside it, or nearer to the root."""
    found: dict[str, str] = {}
    above = path
    while above:
        above = above.rpartition(".")[0]
        found = stamps.get(above, {}) | found
        if _last(found.get("time_field", "")) == SOURCE_TIME:
            found.setdefault("quality_field", f"{above}.StatusCode".lstrip("."))
    return found


def name_in_id(text: str) -> str:
    """Return a tag's name without the namespace of a node id: ``FIC101.PV`` of ``ns=2;s=FIC101.PV``."""
    return text.rpartition(";s=")[2]


def _last(path: str) -> str:
    return plain(path.rpartition(".")[2])


@lru_cache(maxsize=100_000)
def _stamp(path: str) -> str | None:
    """Return the key of a configuration under which a path belongs that is of a time or of a quality."""
    word = _last(path)
    if word in TIMES or is_time(word):
        return "time_field"
    return "quality_field" if word in QUALITIES or ROLE.get(word) == "quality" else None
