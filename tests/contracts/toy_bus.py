"""A bus of one's own, as docs/howto/own_connector.md shows it: lines of JSON over TCP.

A server greets each client with ``{"toy": 1}``, sends it every row and ``{}`` ten times a second, and answers
``{"loop": "FIC101", "active": true}`` by ``{"ok": true}``.
"""

from __future__ import annotations

import asyncio
import contextlib
import json
import math
from collections.abc import Mapping
from contextlib import asynccontextmanager

from connectors.base import ConnectionLostError, LoopRole, Sample
from connectors.cancellation import obey_cancellation
from connectors.kind import ConnectorKind
from connectors.options import LoopTags, Options, Port, Seconds, Target

GREETING = {"toy": 1}


class ToyOptions(Options):
    """A server of the toy bus."""

    port: Port = 7000
    timeout: Seconds = 5.0
    """Longest silence of the server, s."""


class ToyTag(Options):
    """A value."""

    field: str
    """Its key in a row."""


class ToyTarget(Target):
    """An alarm; the server knows it by the name of its loop."""


class ToyConnector:
    """A client of the toy bus."""

    takes_orders = False

    def __init__(self, name: str, options: ToyOptions, loops: Mapping[str, LoopTags[ToyTag, ToyTarget]]):
        self.name = name
        self.options = options
        self.loops = loops

    @asynccontextmanager
    async def session(self):
        async with self.connected() as reader:
            yield ToySession(self, *reader)

    @asynccontextmanager
    async def connected(self):
        """Connect and read the greeting."""
        writer = None
        try:
            async with asyncio.timeout(self.options.timeout):
                reader, writer = await asyncio.open_connection("127.0.0.1", self.options.port)
            if await self.line(reader) != GREETING:
                raise ConnectionLostError("the server did not greet")
            yield reader, writer
        except OSError as error:  # a timeout is one
            raise ConnectionLostError(f"port {self.options.port}: {error or 'no answer'}") from error
        finally:
            if writer is not None:
                writer.transport.abort()

    async def line(self, reader):
        """Read a line; raises ConnectionLostError."""
        try:
            async with asyncio.timeout(self.options.timeout):
                line = json.loads(await reader.readline())
        except (OSError, ValueError, RecursionError) as error:
            raise ConnectionLostError(f"no line of JSON: {error or 'no answer'}") from error
        if not isinstance(line, dict):
            raise ConnectionLostError("a line holds no object")
        return line


class ToySession:
    """An open connection."""

    def __init__(self, connector, reader, writer):
        self.connector = connector
        self.reader = reader
        self.writer = writer

    async def samples(self):
        while True:
            row = await self.connector.line(self.reader)
            obey_cancellation()
            if "time" in row:
                for role, tag in self.connector.loops[row["loop"]].tags.items():
                    value = row[tag.field]
                    value = math.nan if value is None else value
                    yield Sample.measured(LoopRole(row["loop"], role), row["time"], value)

    async def publish(self, publication):
        if publication.kind != "state" or publication.subject not in self.connector.loops:
            return
        async with self.connector.connected() as (reader, writer):
            order = {"loop": publication.subject, "active": publication.fields["active"]}
            writer.write(json.dumps(order).encode() + b"\n")
            while await self.connector.line(reader) != {"ok": True}:
                pass


class ToyPeer:
    """A server of the toy bus, for the checks."""

    lead = 100
    precision = 0.0
    frames = (json.dumps(GREETING).encode() + b"\n",)
    header = 2  # a changed space is still a greeting

    def __init__(self):
        self.port = 0
        self._clients = set()
        self._tasks = set()
        self._newest = {}
        self._alarms = {}
        self._observers = set()

    async def __aenter__(self):
        await self.start()
        return self

    async def __aexit__(self, *_):
        await self.stop()

    async def start(self):
        self._server = await asyncio.start_server(self._serve, "127.0.0.1", self.port)
        self.port = self._server.sockets[0].getsockname()[1]
        self._beating = asyncio.create_task(self._beat())

    async def stop(self):
        self._server.close()
        self._beating.cancel()
        for writer in self._clients:
            writer.transport.abort()
        await asyncio.gather(self._beating, *self._tasks, return_exceptions=True)

    async def put(self, loop, time, values):
        row = {role: None if value != value else value for role, value in values.items()}  # noqa: PLR0124
        self._newest[loop] = line = json.dumps({"loop": loop, "time": time, **row}).encode() + b"\n"
        for writer in self._clients:
            writer.write(line)

    def connection(self, port=None, *, wait=1.0):
        return {"port": self.port if port is None else port, "timeout": wait}

    def loop(self, _):
        return {"tags": {role: {"field": role} for role in ("pv", "op", "sp", "mode")}, "publish": [{}]}

    @asynccontextmanager
    async def alarms(self):
        queue = asyncio.Queue()
        for known in self._alarms.items():
            queue.put_nowait(known)
        self._observers.add(queue)

        async def changes():
            while True:
                yield await queue.get()

        yield changes()
        self._observers.remove(queue)

    async def _serve(self, reader, writer):
        task = asyncio.current_task()
        self._tasks.add(task)
        self._clients.add(writer)
        writer.write(self.frames[0] + b"".join(self._newest.values()))
        try:
            while self._server.is_serving() and (line := await reader.readline()):
                order = json.loads(line)
                self._alarms[order["loop"]] = order["active"]
                for observer in self._observers:
                    observer.put_nowait((order["loop"], order["active"]))
                writer.write(b'{"ok": true}\n')
        except OSError:
            pass
        finally:
            self._clients.remove(writer)
            self._tasks.remove(task)
            writer.transport.abort()

    async def _beat(self):
        while True:
            for writer in self._clients:
                writer.write(b"{}\n")
            await asyncio.sleep(0.1)


def kind_of(connector=ToyConnector):
    return ConnectorKind("toy", ToyOptions, ToyTag, ToyTarget, connector, peers=ToyPeer)


TOY = kind_of()


class Forgetful(ToyConnector):
    """Loses every third row after its first session."""

    sessions = 0

    @asynccontextmanager
    async def session(self):
        self.sessions += 1
        async with super().session() as session:
            if self.sessions > 1:
                session.samples = lambda: self._some(session)
            yield session

    @staticmethod
    async def _some(session):
        async for sample in ToySession.samples(session):
            if sample.time % 3:
                yield sample


class Stubborn(ToyConnector):
    """Goes on reading after its first cancellations, as a library may make it."""

    @asynccontextmanager
    async def session(self):
        async with super().session() as session:
            session.samples = lambda: self._endless(session)
            yield session

    async def _endless(self, session):
        ignored = 0
        while True:
            try:
                row = await self.line(session.reader)
            except asyncio.CancelledError:
                ignored += 1
                if ignored > 3:
                    raise
                continue
            if "time" in row:
                yield Sample.missing(LoopRole(row["loop"], "pv"), row["time"])


class Deaf(ToyConnector):
    """Takes the end of a connection for silence."""

    async def line(self, reader):
        if reader.at_eof():
            await asyncio.Event().wait()
        with contextlib.suppress(ConnectionLostError):
            return await super().line(reader)
        return {}


class Careless(ToyConnector):
    """Passes on whatever exception its library has."""

    async def line(self, reader):
        return json.loads(await asyncio.wait_for(reader.readline(), self.options.timeout))
