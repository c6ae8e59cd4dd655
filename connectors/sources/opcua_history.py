"""History of an OPC UA server (Part 11, raw values), with paging of our own.

asyncua's `read_raw_history` stops, and once looped for ever, where a server repeats a continuation point.
Here a page that brings nothing new, or a point that comes again, ends the use of that point: reading goes on
by time, and where that brings nothing new either, the tag is named.
"""

from __future__ import annotations

import asyncio
import math
from collections.abc import Awaitable, Callable, Mapping
from datetime import UTC, datetime
from typing import TYPE_CHECKING, TypeVar

from asyncua import Client, ua

from connectors.base import AccessDeniedError, ConnectionLostError, Quality
from connectors.cancellation import obey_cancellation
from connectors.exports.cells.tag_roles import tag_role
from connectors.exports.fault import RecordingError
from connectors.opcua.batches import Batches
from connectors.opcua.browse import OBJECTS, Bounds, Variable, walk
from connectors.opcua.connector import as_connection_lost, connected
from connectors.opcua.options import Login, OpcUaOptions, Security
from connectors.opcua.values import in_words, quality
from connectors.sources.address import login_of, parted, password_place
from connectors.sources.collected import CollectedTag
from connectors.sources.tag_source import TagSource

if TYPE_CHECKING:
    from connectors.exports.recorded import ReadOptions

VALUES = 5000
"""Of one page; servers may give fewer."""
GOOD = ua.StatusCode()
T = TypeVar("T")
SECURITY = {"certificate", "key", "server_certificate", "ca"}


class OpcUaHistory(TagSource):
    """``opc.tcp://HOST:4840``: variables below Objects, or below ``?node=ID``, whose history may be read.

    A mapping names tags by their node ids; else a tag is the path of its browse names.
    """

    def __init__(self, name: str, options: ReadOptions) -> None:
        """Make it; nothing is connected yet."""
        super().__init__(name, options)
        self._address = parted(name, {"node", *SECURITY})
        self._options = self._connection()
        self._nodes: dict[str, str] = {}
        """Tag -> node id."""

    def tags(self) -> list[str]:
        """Return the paths of the variables whose history may be read."""
        self._nodes = asyncio.run(self._with_session(self._browse))
        return list(self._nodes)

    def collect(self, wanted: Mapping[str, CollectedTag]) -> None:
        """Read the history of some variables, in one session."""

        async def read(client: Client) -> None:
            for tag, into in wanted.items():
                await self._history(client, tag, into)

        asyncio.run(self._with_session(read))

    def _connection(self) -> OpcUaOptions:
        of = self._address.parameters
        login = login_of(self._address)
        given = {key: of[key] for key in SECURITY if key in of}
        try:
            security = Security.model_validate(given) if given else None
            return OpcUaOptions(
                url=self._address.base(),
                security=security,
                login=None if login is None else Login(user=login[0], password=password_place()),
            )
        except ValueError as error:
            words = "; ".join(line.strip() for line in str(error).splitlines()[1:3])
            raise RecordingError(f"{self.name}: {words}") from error

    async def _with_session(self, work: Callable[[Client], Awaitable[T]]) -> T:
        try:
            async with connected(self._options) as client:
                with as_connection_lost():
                    return await work(client)
        except (ConnectionLostError, AccessDeniedError) as error:
            raise RecordingError(f"{self.name}: {error}") from error

    async def _browse(self, client: Client) -> dict[str, str]:
        found = await walk(client, Bounds(), self._address.parameters.get("node", OBJECTS))
        roles = [each for each in found.variables if tag_role(_tag(each)) is not None]
        levels = await Batches().ask(
            lambda nodes: client.uaclient.read_attributes(nodes, ua.AttributeIds.AccessLevel),
            [ua.NodeId.from_string(each.node) for each in roles],
        )
        return {
            _tag(each): each.node for each, level in zip(roles, levels, strict=True) if _has_history(level)
        }

    async def _history(self, client: Client, tag: str, into: CollectedTag) -> None:
        try:
            node = ua.NodeId.from_string(self._nodes.get(tag, tag))
        except ua.UaError as error:
            raise RecordingError(f"{self.name}: tag {tag}: expected a node id as ns=2;s=FIC101.PV") from error
        start, last, point = self.start, -math.inf, None
        while True:
            values, following = await self._page(client, tag, node, start, point)
            obey_cancellation()
            new = [(time, data) for time, data in values if last < time < self.end]
            for time, data in new:
                into.add(time, _plain(data), good=quality(data.StatusCode or GOOD) is not Quality.BAD)
            last = max((time for time, _ in new), default=last)
            if new and following and following != point:
                point = following
                continue
            if following:
                await self._page(client, tag, node, start, following, release=True)
            elif len(values) < VALUES or not new:
                return
            if not new and point is None:
                raise RecordingError(
                    f"{self.name}: tag {tag}: the server repeats the values at {_iso(start)}"
                )
            start, point = last, None  # on by time

    async def _page(
        self,
        client: Client,
        tag: str,
        node: ua.NodeId,
        start: float,
        point: bytes | None,
        *,
        release: bool = False,
    ) -> tuple[list[tuple[float, ua.DataValue]], bytes | None]:
        """Return values with their times, and the continuation point of the rest; None: there is none."""
        wanted = ua.HistoryReadValueId(NodeId=node, ContinuationPoint=point)
        details = ua.ReadRawModifiedDetails(
            StartTime=_moment(start), EndTime=_moment(self.end), NumValuesPerNode=VALUES, ReturnBounds=False
        )
        request = ua.HistoryReadParameters(
            HistoryReadDetails=details,
            TimestampsToReturn=ua.TimestampsToReturn.Both,
            ReleaseContinuationPoints=release,
            NodesToRead=[wanted],
        )
        (result,) = await client.uaclient.history_read(request)
        if release:
            return [], None
        if result.StatusCode.is_bad():
            raise RecordingError(f"{self.name}: tag {tag}: {in_words(result.StatusCode)}")
        values = getattr(result.HistoryData, "DataValues", None) or []
        stamped = [(_seconds(data), data) for data in values if data.SourceTimestamp or data.ServerTimestamp]
        return stamped, result.ContinuationPoint or None


def _tag(variable: Variable) -> str:
    return "/".join(variable.path)


def _has_history(level: ua.DataValue) -> bool:
    value = level.Value.Value if level.Value is not None else None
    return isinstance(value, int) and bool(value & (1 << ua.AccessLevel.HistoryRead))


def _plain(data: ua.DataValue) -> object:
    return data.Value.Value if data.Value is not None else None


def _seconds(data: ua.DataValue) -> float:
    stamp: datetime = data.SourceTimestamp or data.ServerTimestamp
    return stamp.replace(tzinfo=stamp.tzinfo or UTC).timestamp()


def _moment(time: float) -> datetime:
    """Return a time as asyncua writes it: without a zone it means UTC."""
    return datetime.fromtimestamp(time, UTC).replace(tzinfo=None)


def _iso(time: float) -> str:
    return datetime.fromtimestamp(time, UTC).isoformat()
