"""OPC UA as a connector: every session is a fresh client with its own subscription."""

from __future__ import annotations

import asyncio
import logging
import time
from collections.abc import AsyncGenerator, AsyncIterator, Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, asynccontextmanager, contextmanager

from asyncua import Client, ua
from asyncua.common.ua_utils import data_type_to_variant_type

from connectors.base import (
    AccessDeniedError,
    ConnectionLostError,
    JsonValue,
    LoopRole,
    Order,
    Publication,
    RefusedError,
    Sample,
    Session,
    TargetReport,
)
from connectors.cancellation import ends_when_cancelled, obey_cancellation
from connectors.opcua.batches import Batches
from connectors.opcua.notification import ValueBlock
from connectors.opcua.options import OpcUaOptions, OpcUaTag, OpcUaTarget
from connectors.opcua.rows import LoopRows
from connectors.opcua.security import identify, refusal
from connectors.opcua.silence import Silence
from connectors.opcua.subscription import NodeReport, subscription
from connectors.opcua.values import in_words, no_write, variant
from connectors.options import LoopTags
from connectors.readings import Readings, one_by_one

logging.getLogger("asyncua").setLevel(
    logging.CRITICAL
)  # what it logs, the session raises; passwords at DEBUG

_SESSION_TIMEOUT = 60_000
"""How long the server keeps a session that it hears nothing from, ms; its watchdog reads more often."""
_AT_ONCE = 100
"""Pieces that are read before others have their turn: one notification may have thousands."""

OpcUaLoops = Mapping[str, LoopTags[OpcUaTag, OpcUaTarget]]


class OpcUaConnector:
    """An OPC UA server, what is read from it and written to it."""

    takes_orders = False

    def __init__(self, name: str, options: OpcUaOptions, loops: OpcUaLoops) -> None:
        self.name = name
        self._options = options
        self._loops = loops
        self.lost = 0
        """Values that were discarded before they were read, since the start."""

    @asynccontextmanager
    async def session(self) -> AsyncIterator[Session]:
        """Connect; raises ConnectionLostError."""
        async with connected(self._options) as client:
            lost = self.lost

            def count_lost(more: int) -> None:
                self.lost = lost + more

            yield OpcUaSession(client, self._options, self._loops, count_lost)


class OpcUaSession:
    """An open connection."""

    def __init__(
        self, client: Client, options: OpcUaOptions, loops: OpcUaLoops, count_lost: Callable[[int], None]
    ) -> None:
        self._client = client
        self._count_lost = count_lost
        """Takes how many values were discarded in this session."""
        self._options = options
        self._loops = loops
        self._types: dict[str, ua.VariantType] = {}
        self._tags: dict[str, list[LoopRole]] = {}
        for name, loop in loops.items():
            for role, tag in loop.tags.items():
                self._tags.setdefault(tag.node, []).append(LoopRole(name, role))
        self._rows = LoopRows(self._tags)

    def samples(self) -> AsyncIterator[Sample | Order]:
        """Yield every change; raises ConnectionLostError."""
        return one_by_one(self.readings())

    async def readings(self) -> AsyncGenerator[Sample | Order | Readings]:
        """Yield the same, those of a loop with one time in one piece.

        A node that is not there is reported once and tried again now and then; one that is silent is read.
        """
        with as_connection_lost():
            watched = await subscription(self._client, self._options)
            silence = Silence()
            absent: set[str] = set()
            wanted = list(self._tags)
            due = time.monotonic()
            while True:
                if time.monotonic() >= due:
                    wanted += [
                        node
                        for node, read in (await watched.read(silence.silent())).items()
                        if silence.is_lost(node, read)
                    ]
                    refused = await watched.add(wanted)
                    for node in wanted:
                        if node not in refused:
                            silence.watch(node)
                    for node in refused.keys() - absent:
                        for name in self._tags[node]:
                            status = refused[node]
                            yield Sample.missing(name, time.time(), status.value, in_words(status))
                    absent = set(refused)
                    wanted = list(refused)
                    due = time.monotonic() + self._options.retry
                changes = await watched.changes(min(self._options.timeout, self._options.retry))
                obey_cancellation()
                self._count_lost(watched.lost)
                for k, each in enumerate(self._pieces_of(changes, silence), start=1):
                    yield each
                    if k % _AT_ONCE == 0:
                        await asyncio.sleep(0)

    def _pieces_of(self, changes: Sequence[NodeReport], silence: Silence) -> Iterator[Sample | Readings]:
        for nodes, values in changes:
            told = (
                values.values.tolist() if isinstance(values, ValueBlock) else [each.value for each in values]
            )
            silence.told(nodes, told)
            yield from self._rows.pieces(nodes, values)

    async def publish(self, publication: Publication) -> None:
        """Write a state or its end, the flag last; raises ConnectionLostError, RefusedError."""
        if publication.kind == "event" or publication.subject not in self._loops:
            return
        refused: dict[str, ua.StatusCode] = {}
        for target in self._loops[publication.subject].targets:
            fields = {tag.node: publication.fields.get(name) for name, tag in target.fields.items()}
            if target.active is not None:
                fields[target.active.node] = bool(publication.fields.get("active"))
            with as_connection_lost():
                refused |= await self._write(fields)
        if refused:
            raise RefusedError("; ".join(f"{node}: {status.name}" for node, status in refused.items()))

    async def check_targets(self) -> list[TargetReport]:
        """Read the rights to each node that would be written; raises ConnectionLostError."""
        places = [
            (loop, tag.node)
            for loop, entry in self._loops.items()
            for target in entry.targets
            for tag in [*target.fields.values(), *filter(None, [target.active])]
        ]

        async def rights(nodes: list[ua.NodeId]) -> list[ua.DataValue]:
            found: list[ua.DataValue] = await self._client.uaclient.read_attributes(
                nodes, ua.AttributeIds.UserAccessLevel
            )
            return found

        with as_connection_lost():
            answers = await Batches().ask(rights, [ua.NodeId.from_string(node) for _, node in places])
        return [
            TargetReport(loop, node, no_write(answer))
            for (loop, node), answer in zip(places, answers, strict=True)
        ]

    async def _write(self, fields: Mapping[str, JsonValue]) -> dict[str, ua.StatusCode]:
        """Write each node's value in the node's own type, all in one request; return what was refused."""
        refused = await self._learn_types([node for node in fields if node not in self._types])
        values = {node: variant(fields[node], self._types[node]) for node in fields if node not in refused}
        nodes = [node for node, value in values.items() if value is not None]
        if nodes:  # many a server calls an empty request a fault
            results = await self._client.uaclient.write_attributes(
                [ua.NodeId.from_string(node) for node in nodes],
                [ua.DataValue(values[node]) for node in nodes],
            )
            refused |= {node: said for node, said in zip(nodes, results, strict=True) if not said.is_good()}
        for node in refused:
            self._types.pop(node, None)  # it may be another one when it is back
        return refused

    async def _learn_types(self, nodes: list[str]) -> dict[str, ua.StatusCode]:
        if not nodes:
            return {}
        answers = await self._client.uaclient.read_attributes(
            [ua.NodeId.from_string(node) for node in nodes], ua.AttributeIds.DataType
        )
        refused = {}
        for node, answer in zip(nodes, answers, strict=True):
            if not answer.StatusCode.is_good():
                refused[node] = answer.StatusCode
                continue
            try:
                kind = await data_type_to_variant_type(self._client.get_node(answer.Value.Value))
            except ua.UaStatusCodeError as error:  # its type is of a kind that the server does not describe
                refused[node] = ua.StatusCode(error.code)
            else:
                self._types[node] = kind
        return refused


@asynccontextmanager
async def connected(options: OpcUaOptions) -> AsyncIterator[Client]:
    """Connect a fresh client; raises ConnectionLostError, AccessDeniedError."""
    client = Client(options.url, timeout=options.timeout, watchdog_intervall=options.timeout)
    client.session_timeout = _SESSION_TIMEOUT
    with as_connection_lost(f"OPC UA server at {options.url}: "), ExitStack() as unless_connected:
        unless_connected.callback(client.disconnect_socket)
        await identify(client, options)
        try:
            await ends_when_cancelled(client.connect())
        except AssertionError as error:  # asyncua takes for granted what a server answers
            raise ua.UaError("the server does not open a secure channel") from error
        unless_connected.pop_all()
    try:
        yield client
    finally:
        await client.disconnect()


@contextmanager
def as_connection_lost(peer: str = "") -> Iterator[None]:
    """Raise what asyncua and sockets raise as ConnectionLostError or AccessDeniedError of ``peer``."""
    try:
        yield
    except AccessDeniedError as error:
        raise AccessDeniedError(f"{peer}{error}") from error
    except TimeoutError as error:
        raise ConnectionLostError(f"{peer}the server does not answer") from error
    except (OSError, ua.UaError) as error:
        if peer and (why := refusal(error)) is not None:
            raise AccessDeniedError(f"{peer}{why}") from error
        raise ConnectionLostError(f"{peer}{str(error) or type(error).__name__}") from error
