"""Finds the loops of an OPC UA server by the names of its nodes, and of a broker by what is published."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass

from agent.runtime.commission.heard_tags import heard_tags
from agent.settings.tag_names import NamedTag, TagGroup, groups_by_convention, groups_by_pattern
from connectors.mqtt.heard import hear
from connectors.mqtt.options import MqttOptions
from connectors.opcua.browse import OBJECTS, Bounds, Variable, values, walk
from connectors.opcua.connector import connected
from connectors.opcua.options import OpcUaOptions

_RANGE = "EURange"
"""Property of an analog item with the span of its value (OPC UA Part 8, 5.3.2.3)."""


@dataclass(frozen=True, slots=True)
class FoundLoop:
    """A loop, as its server or broker has it."""

    name: str
    by: str
    """Control system whose names match, or the pattern that found it."""
    tags: Mapping[str, Mapping[str, object]]
    """Role -> where its value is, as in a configuration."""
    values: Mapping[str, object]
    """Role -> the value, where that is not bad."""
    spans: Mapping[str, tuple[float, float]]
    """Role -> range of its values, where the server has one."""

    def entry(self, connection: str, ts: float) -> dict[str, object]:
        """Return its entry in a configuration."""
        ranges = {f"{role}_range": list(self.spans[role]) for role in ("op", "pv") if role in self.spans}
        tags = {role: dict(tag) for role, tag in self.tags.items()}
        return {"name": self.name, "connection": connection, "ts": ts, **ranges, "tags": tags}


@dataclass(frozen=True, slots=True)
class LoopSearch:
    """What a search found."""

    loops: tuple[FoundLoop, ...]
    nodes: int
    """Nodes, or topics, that were seen."""
    variables: int
    """Variables of these, or values in their messages."""
    stopped: str | None
    """The bound that ended it; None where all was seen."""
    called: tuple[str, str] = ("nodes", "variables")
    """What these are."""


async def find_loops(
    options: OpcUaOptions,
    bounds: Bounds,
    root: str = OBJECTS,
    patterns: Mapping[str, str] | None = None,
    progress: Callable[[int, int], None] = lambda _seen, _waiting: None,
) -> LoopSearch:
    """Look at all nodes below ``root`` and read those of the loops; raises ConnectionLostError.

    Args:
        options: The server.
        bounds: Where to end.
        root: Node id to begin at.
        patterns: Role -> name with one ``*``; None takes the names of common control systems.
        progress: As in ``walk``.
    """
    async with connected(options) as client:
        walked = await walk(client, bounds, root, progress)
        tags = [NamedTag(each.node, _names(each)) for each in walked.variables]
        groups = _groups(tags, patterns)
        paths = {each.node: each.path for each in walked.variables}
        below = {each.path[:-1]: each.node for each in walked.variables if each.path[-1] == _RANGE}
        members = [tag.address for group in groups for tag in group.tags.values()]
        ranges = {node: below[paths[node]] for node in members if paths[node] in below}
        held = await values(client, [*members, *ranges.values()])
    spans = {node: span for node, range_ in ranges.items() if (span := _span(held.get(range_))) is not None}
    loops = tuple(_found(group, held, spans) for group in groups if _is_numeric(group, held))
    return LoopSearch(loops, walked.nodes, len(walked.variables), walked.stopped)


async def find_published_loops(
    options: MqttOptions,
    topics: str,
    bounds: Bounds,
    patterns: Mapping[str, str] | None = None,
    progress: Callable[[int, int], None] = lambda _seen, _waiting: None,
) -> LoopSearch:
    """Hear what a broker's clients publish and find the loops in it; raises ConnectionLostError.

    Args:
        options: The broker.
        topics: Filter with wildcards.
        bounds: Where to end: its ``nodes`` are topics, its ``depth`` does not count.
        patterns: As of ``find_loops``.
        progress: Called now and then with the s that have passed and those that are left.
    """
    length = round(bounds.seconds)
    heard = await hear(
        options, topics, bounds.seconds, bounds.nodes, lambda past: progress(length, length - round(past))
    )

    def loops_of(names: Iterable[str]) -> int:
        return len(_groups([NamedTag(each, (each,)) for each in names], patterns))

    found = [
        tag for topic, payloads in heard.messages.items() for tag in heard_tags(topic, payloads, loops_of)
    ]
    tags = {str(place): tag for place, tag in enumerate(found)}
    groups = _groups([NamedTag(place, (tag.name,)) for place, tag in tags.items()], patterns)
    held = {place: tag.value for place, tag in tags.items()}
    loops = tuple(
        FoundLoop(
            group.name,
            group.by,
            {role: tags[tag.address].tag for role, tag in group.tags.items()},
            {role: held[tag.address] for role, tag in group.tags.items()},
            {},
        )
        for group in groups
        if _is_numeric(group, held)
    )
    return LoopSearch(loops, len(heard.messages), len(found), heard.stopped, ("topics", "values"))


def _groups(tags: Iterable[NamedTag], patterns: Mapping[str, str] | None) -> tuple[TagGroup, ...]:
    return groups_by_pattern(tags, patterns) if patterns else groups_by_convention(tags)


def _found(
    group: TagGroup, held: Mapping[str, object], spans: Mapping[str, tuple[float, float]]
) -> FoundLoop:
    nodes = {role: tag.address for role, tag in group.tags.items()}
    return FoundLoop(
        group.name,
        group.by,
        {role: {"node": node} for role, node in nodes.items()},
        {role: held[node] for role, node in nodes.items() if node in held},
        {role: spans[node] for role, node in nodes.items() if node in spans},
    )


def _names(variable: Variable) -> tuple[str, ...]:
    """Return the names of a node: its path, and the text of its id where it is one."""
    path = "/".join(variable.path)
    id_ = variable.node.rpartition("ns=")[2].partition(";")[2] if ";" in variable.node else variable.node
    return (path, id_.removeprefix("s=")) if id_.startswith("s=") else (path,)


def _is_numeric(group: TagGroup, held: Mapping[str, object]) -> bool:
    """Whether PV and OP may be numbers; those without a value may."""
    found = [held.get(group.tags[role].address) for role in ("pv", "op")]
    return all(
        each is None or (isinstance(each, int | float) and not isinstance(each, bool)) for each in found
    )


def _span(held: object) -> tuple[float, float] | None:
    low, high = getattr(held, "Low", None), getattr(held, "High", None)
    if isinstance(low, int | float) and isinstance(high, int | float) and low < high:
        return float(low), float(high)
    return None
