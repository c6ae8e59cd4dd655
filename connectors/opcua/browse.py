"""Walks the address space of a server, level by level, within bounds: plants have millions of nodes."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from asyncua import Client, ua

from connectors.base import ConnectionLostError, Quality
from connectors.opcua.batches import Batches
from connectors.opcua.connector import as_connection_lost
from connectors.opcua.values import in_words, quality

OBJECTS = "i=85"
_SERVER = "i=2253"
"""Nodes about the server itself: nothing of the plant is below."""
_AT_ONCE = 64
"""Nodes looked into between two looks at the bounds."""
_ANSWERS = 1000
"""Most references of a node in one answer; the rest comes with the next."""


@dataclass(frozen=True, slots=True)
class Bounds:
    """Where a walk ends."""

    depth: int = 12
    """Levels below the first node."""
    nodes: int = 100_000
    seconds: float = 120.0


@dataclass(frozen=True, slots=True)
class Variable:
    """A variable of the server."""

    node: str
    """Its node id, e.g. ``ns=2;s=FIC101.PV``."""
    path: tuple[str, ...]
    """Browse names from below the first node down to it."""


@dataclass(frozen=True, slots=True)
class Walk:
    """What was found."""

    variables: tuple[Variable, ...]
    nodes: int
    """Nodes that were seen."""
    stopped: str | None
    """The bound that ended it; None where all was seen."""


async def walk(
    client: Client,
    bounds: Bounds,
    root: str = OBJECTS,
    progress: Callable[[int, int], None] = lambda _seen, _waiting: None,
) -> Walk:
    """Return all variables below ``root``; raises ConnectionLostError, also where there is no such node.

    Args:
        client: Connected.
        bounds: Where to end.
        root: Node id of the first node.
        progress: Called now and then with the nodes seen and those of them that wait to be looked into.
    """
    with as_connection_lost():
        (there,) = await client.uaclient.read_attributes(
            [ua.NodeId.from_string(root)], ua.AttributeIds.NodeClass
        )
    if there.StatusCode is not None and not there.StatusCode.is_good():
        raise ConnectionLostError(f"node {root}: {in_words(there.StatusCode)}")
    end = time.monotonic() + bounds.seconds
    walker = _Walker(client, root)
    for _ in range(bounds.depth):
        while walker.level:
            await walker.step()
            progress(walker.seen, len(walker.level) + len(walker.below))
            if walker.seen > bounds.nodes:
                return walker.result(f"{bounds.nodes} nodes")
            if time.monotonic() > end:
                return walker.result(f"{bounds.seconds:g} s")
        walker.level, walker.below = walker.below, []
        if not walker.level:
            return walker.result(None)
    return walker.result(f"{bounds.depth} levels")


class _Walker:
    """Where a walk is."""

    def __init__(self, client: Client, root: str) -> None:
        self._client = client
        self._known = {root, _SERVER}
        self._variables: list[Variable] = []
        self._batches = Batches()
        self.level: list[tuple[str, tuple[str, ...]]] = [(root, ())]
        """Nodes of this level that wait, with their paths."""
        self.below: list[tuple[str, tuple[str, ...]]] = []

    @property
    def seen(self) -> int:
        """Nodes that were seen."""
        return len(self._known) - 1

    def result(self, stopped: str | None) -> Walk:
        return Walk(tuple(self._variables), self.seen, stopped)

    async def step(self) -> None:
        """Look into the next nodes of this level."""
        batch, self.level = self.level[:_AT_ONCE], self.level[_AT_ONCE:]
        with as_connection_lost():
            answers = await self._batches.ask(self._children, [node for node, _ in batch])
        for (_, path), children in zip(batch, answers, strict=True):
            for child in children:
                self._take(child, path)

    async def _children(self, nodes: list[str]) -> list[list[ua.ReferenceDescription]]:
        """Return what is below each node, in as many answers as it takes."""
        wanted = ua.BrowseParameters()
        wanted.RequestedMaxReferencesPerNode = _ANSWERS
        wanted.NodesToBrowse = [_description(node) for node in nodes]
        results = await self._client.uaclient.browse(wanted)
        found = [list(result.References or []) for result in results]
        points = {index: result.ContinuationPoint for index, result in enumerate(results)}
        while left := {index: point for index, point in points.items() if point}:
            more = ua.BrowseNextParameters()
            more.ContinuationPoints = list(left.values())
            results = await self._client.uaclient.browse_next(more)
            points = {}
            for index, result in zip(left, results, strict=True):
                found[index] += result.References or []
                points[index] = result.ContinuationPoint
        return found

    def _take(self, child: ua.ReferenceDescription, path: tuple[str, ...]) -> None:
        node = child.NodeId.to_string()
        if node in self._known or getattr(child.NodeId, "ServerIndex", None):
            return  # a hierarchy may have circles, and lead to other servers
        self._known.add(node)
        names = (*path, child.BrowseName.Name or "")
        self.below.append((node, names))
        if child.NodeClass is ua.NodeClass.Variable:
            self._variables.append(Variable(node, names))


async def values(client: Client, nodes: Sequence[str]) -> dict[str, object]:
    """Return node -> value, of those that have one that is not bad; raises ConnectionLostError."""

    async def read(batch: list[ua.NodeId]) -> list[ua.DataValue]:
        found: list[ua.DataValue] = await client.uaclient.read_attributes(batch, ua.AttributeIds.Value)
        return found

    with as_connection_lost():
        answers = await Batches().ask(read, [ua.NodeId.from_string(node) for node in nodes])
    return {
        node: answer.Value.Value
        for node, answer in zip(nodes, answers, strict=True)
        if answer.Value is not None and quality(answer.StatusCode or ua.StatusCode()) is not Quality.BAD
    }


def _description(node: str) -> ua.BrowseDescription:
    wanted = ua.BrowseDescription()
    wanted.NodeId = ua.NodeId.from_string(node)
    wanted.BrowseDirection = ua.BrowseDirection.Forward
    wanted.ReferenceTypeId = ua.NodeId(ua.ObjectIds.HierarchicalReferences)
    wanted.IncludeSubtypes = True
    wanted.NodeClassMask = ua.NodeClass.Object | ua.NodeClass.Variable
    wanted.ResultMask = ua.BrowseResultMask.All
    return wanted
