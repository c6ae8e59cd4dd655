"""Finds the loops of an OPC UA server by the names of its nodes."""

from __future__ import annotations

from collections.abc import Callable

from agent.runtime.commission.found_loops import LoopSearch, Patterns, found_loops, groups_of
from agent.settings.tag_names import NamedTag
from connectors.opcua.browse import OBJECTS, Bounds, Variable, values, walk
from connectors.opcua.connector import connected
from connectors.opcua.options import OpcUaOptions

_RANGE = "EURange"
"""Property of an analog item with the span of its value (OPC UA Part 8, 5.3.2.3)."""


async def find_loops(
    options: OpcUaOptions,
    bounds: Bounds,
    root: str = OBJECTS,
    patterns: Patterns | None = None,
    progress: Callable[[int, int], None] = lambda _seen, _waiting: None,
) -> LoopSearch:
    """Look at all nodes below ``root`` and read those of the loops; raises ConnectionLostError.

    Args:
        options: The server.
        bounds: Where to end.
        root: Node id to begin at.
        patterns: Of the names.
        progress: As in ``walk``.
    """
    async with connected(options) as client:
        walked = await walk(client, bounds, root, progress)
        tags = [NamedTag(each.node, _names(each)) for each in walked.variables]
        groups = groups_of(tags, patterns)
        paths = {each.node: each.path for each in walked.variables}
        below = {each.path[:-1]: each.node for each in walked.variables if each.path[-1] == _RANGE}
        members = [tag.address for group in groups for tag in group.tags.values()]
        ranges = {node: below[paths[node]] for node in members if paths[node] in below}
        held = await values(client, [*members, *ranges.values()])
    spans = {node: span for node, range_ in ranges.items() if (span := _span(held.get(range_))) is not None}
    loops = found_loops(groups, {node: {"node": node} for node in members}, held, spans)
    return LoopSearch(loops, walked.nodes, len(walked.variables), walked.stopped)


def _names(variable: Variable) -> tuple[str, ...]:
    """Return the names of a node: its path, and the text of its id where it is one."""
    path = "/".join(variable.path)
    id_ = variable.node.rpartition("ns=")[2].partition(";")[2] if ";" in variable.node else variable.node
    return (path, id_.removeprefix("s=")) if id_.startswith("s=") else (path,)


def _span(held: object) -> tuple[float, float] | None:
    low, high = getattr(held, "Low", None), getattr(held, "High", None)
    if isinstance(low, int | float) and isinstance(high, int | float) and low < high:
        return float(low), float(high)
    return None
