"""asyncua's server with the history of the tests, in a thread; it may page badly."""

import asyncio
import threading
from contextlib import contextmanager
from datetime import UTC, datetime

from asyncua import Server, ua

from tests.contracts.sources_served.history import held

PAGING = ("good", "repeats", "same_point", "none", "stuck")
"""How the server pages: as it should; with a point that leads back to the first page; with one point for all
pages; full pages without a point; without ever going on."""
PAGE = 50


class PagedHistory:
    """Answers history reads from memory, page by page."""

    def __init__(self):
        self.values = {}
        self.paging = "good"
        self.requests = 0

    async def read(self, params):
        """Stand in for the server's service."""
        details = params.HistoryReadDetails
        return (
            [self._read(details, each) for each in params.NodesToRead]
            if not (params.ReleaseContinuationPoints)
            else [ua.HistoryReadResult() for _ in params.NodesToRead]
        )

    def _read(self, details, wanted):
        self.requests += 1
        result = ua.HistoryReadResult()
        name = wanted.NodeId.Identifier
        if name not in self.values:
            result.StatusCode = ua.StatusCode(ua.StatusCodes.BadNodeIdUnknown)
            return result
        start, end = (each.replace(tzinfo=UTC).timestamp() for each in (details.StartTime, details.EndTime))
        found = [each for each in self.values[name] if start <= each.time <= end]
        at = int(wanted.ContinuationPoint or b"0")
        page = PAGE if self.paging != "none" else details.NumValuesPerNode
        if self.paging in {"repeats", "stuck"}:
            at = 0
        if self.paging == "same_point":
            at, self._at = (0, PAGE) if not wanted.ContinuationPoint else (self._at, self._at + PAGE)
        if self.paging == "stuck":
            found = self.values[name][1:]
        data = ua.HistoryData()
        data.DataValues = [_data(each) for each in found[at : at + page]]
        result.HistoryData = data
        if at + page < len(found) and self.paging != "none":
            point = {"good": str(at + page), "repeats": "1", "same_point": "1", "stuck": "1"}[self.paging]
            result.ContinuationPoint = point.encode()
        return result


def _data(each):
    status = ua.StatusCodes.Good if each.good else ua.StatusCodes.BadSensorFailure
    moment = datetime.fromtimestamp(each.time, UTC).replace(tzinfo=None)
    return ua.DataValue(ua.Variant(each.value), ua.StatusCode(status), SourceTimestamp=moment)


@contextmanager
def served():
    """Serve; give the port and the history."""
    history, ready, stop = PagedHistory(), threading.Event(), threading.Event()
    history.values = held()
    port = []

    async def serve():
        server = Server()
        await server.init()
        server.set_endpoint("opc.tcp://127.0.0.1:0/plant")
        server.set_security_policy([ua.SecurityPolicyType.NoSecurity])
        await server.get_namespace_array()
        for name in history.values:
            loop, _, role = name.rpartition(".")
            parent = server.nodes.objects if not loop else await _folder(server, loop)
            node = await parent.add_variable(ua.NodeId(name, 2), ua.QualifiedName(role or name, 2), 0.0)
            level = ua.AccessLevel.CurrentRead.mask | ua.AccessLevel.HistoryRead.mask
            rights = ua.DataValue(ua.Variant(level, ua.VariantType.Byte))
            await node.write_attribute(ua.AttributeIds.AccessLevel, rights)
        server.iserver.history_manager.read_history = history.read
        async with server:
            port.append(server.bserver._server.sockets[0].getsockname()[1])
            ready.set()
            await asyncio.to_thread(stop.wait)

    folders = {}

    async def _folder(server, loop):
        if loop not in folders:
            name = ua.QualifiedName(loop, 2)
            folders[loop] = await server.nodes.objects.add_object(ua.NodeId(loop, 2), name)
        return folders[loop]

    thread = threading.Thread(target=asyncio.run, args=(serve(),))
    thread.start()
    try:
        assert ready.wait(30)
        yield port[0], history
    finally:
        stop.set()
        thread.join()
