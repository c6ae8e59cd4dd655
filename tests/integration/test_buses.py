"""What holds on every bus: nothing lost, alarms delivered, a dead peer told in time."""

import asyncio
import contextlib
import time

import pytest
from buses import Reading, assert_same, connector_to, free_port, played, serving, until, wave

from connectors.base import ConnectionLostError, Publication
from simulators.servers.broker import embedded_broker
from simulators.servers.modbus import ModbusServer
from simulators.servers.mqtt import MqttServer
from simulators.servers.opcua import OpcUaServer

BUSES = ("modbus", "opcua", "mqtt")
QUICK = {
    "modbus": {"timeout": 0.3},
    "opcua": {"timeout": 0.5, "keep_alive": 5},
    "mqtt": {"timeout": 1.0, "keepalive": 1},
}
ROLES = ("pv", "op", "sp", "mode")


def alarm(loop, *, active):
    fields = {
        "active": active,
        "state": "unack_active",
        "loop": loop,
        "f_s": 2.5,
        "f_d": 1.5,
        "s": 4.0,
        "j": None,
    }
    return Publication(loop, "state", "1", fields)


class StallingProxy:
    """A TCP proxy that can turn into a black hole: connections stay open, nothing comes through."""

    def __init__(self, port):
        self._upstream = port
        self._stalled = False
        self._tasks = set()

    async def __aenter__(self):
        self._server = await asyncio.start_server(self._accept, "127.0.0.1", 0)
        self.port = self._server.sockets[0].getsockname()[1]
        return self

    async def __aexit__(self, *_):
        self._server.close()
        for task in self._tasks:
            task.cancel()
        await asyncio.gather(*self._tasks, return_exceptions=True)
        await self._server.wait_closed()

    def stall(self):
        self._stalled = True

    async def _accept(self, reader, writer):
        self._tasks.add(asyncio.current_task())
        up_reader, up_writer = await asyncio.open_connection("127.0.0.1", self._upstream)
        with contextlib.suppress(asyncio.CancelledError):
            await asyncio.gather(self._pump(reader, up_writer), self._pump(up_reader, writer))
        for stream in (writer, up_writer):
            stream.close()
            with contextlib.suppress(OSError):
                await stream.wait_closed()

    async def _pump(self, reader, writer):
        with contextlib.suppress(OSError):
            while data := await reader.read(4096):
                if not self._stalled:
                    writer.write(data)
        writer.close()


@pytest.mark.parametrize("bus", BUSES)
async def test_every_row_arrives_at_full_speed(bus):
    sources = [wave("FIC101", 300), wave("TIC102", 300, gap=11)]
    async with serving(bus, {source.loop: ROLES for source in sources}) as server:
        reading = await played(server, connector_to(server, ["FIC101", "TIC102"]), sources)
    for source in sources:
        assert_same(reading, source, single=bus == "modbus")


@pytest.mark.parametrize("bus", BUSES)
async def test_an_independent_client_sees_the_alarm_come_and_go(bus):
    loops = ["FIC101", "TIC102"]
    seen = []
    async with serving(bus, dict.fromkeys(loops, ROLES)) as server:

        async def watch():
            async for loop, active in server.watch_alarms():
                seen.append((loop, active))

        watcher = asyncio.create_task(watch())
        try:
            async with connector_to(server, loops).session() as session:
                if bus == "mqtt":  # nothing is said before the first alarm
                    await session.publish(alarm("TIC102", active=False))
                await until(lambda: ("TIC102", False) in seen)
                await session.publish(alarm("a loop of another connection", active=True))
                await session.publish(alarm("FIC101", active=True))
                await until(lambda: ("FIC101", True) in seen)
                await session.publish(alarm("FIC101", active=False))
                await until(lambda: seen[-1] == ("FIC101", False))
                assert ("TIC102", True) not in seen
        finally:
            watcher.cancel()
            with contextlib.suppress(asyncio.CancelledError):
                await watcher


@pytest.mark.parametrize("bus", BUSES)
async def test_a_peer_that_goes_away_is_told(bus):
    source = wave("FIC101", 3)
    async with contextlib.AsyncExitStack() as stack:
        server = await stack.enter_async_context(serving(bus, {"FIC101": ROLES}))
        connector = connector_to(server, ["FIC101"], **QUICK[bus])
        async with connector.session() as session, Reading(session) as reading:
            await server.put("FIC101", next(source.rows()))
            await until(lambda: reading.samples)
            await stack.aclose()
            with pytest.raises(ConnectionLostError):
                await reading.end(within=5.0)
        with pytest.raises(ConnectionLostError):
            async with connector.session():
                pass


@pytest.mark.parametrize("bus", BUSES)
async def test_a_black_hole_is_told_though_the_connection_stays_open(bus):
    async with serving(bus, {"FIC101": ROLES}) as server, StallingProxy(server.port) as proxy:
        there = (
            {"url": f"opc.tcp://127.0.0.1:{proxy.port}"}
            if bus == "opcua"
            else {"host": "127.0.0.1", "port": proxy.port}
        )
        connector = connector_to(server, ["FIC101"], **there, **QUICK[bus])
        async with connector.session() as session, Reading(session) as reading:
            await server.put("FIC101", next(wave("FIC101", 1).rows()))
            await until(lambda: reading.samples)
            proxy.stall()
            began = time.monotonic()
            with pytest.raises(ConnectionLostError):
                await reading.end(within=8.0)
            assert time.monotonic() - began < 6.0
            with pytest.raises(ConnectionLostError):
                await session.publish(alarm("FIC101", active=True))


@pytest.mark.parametrize("make", [ModbusServer, OpcUaServer, MqttServer])
async def test_nobody_there_is_told(make):
    never_started = make({"FIC101": ROLES}, port=free_port())
    with pytest.raises(ConnectionLostError, match=r"\w"):
        async with connector_to(never_started, ["FIC101"]).session():
            pass


@pytest.mark.parametrize("make", [ModbusServer, OpcUaServer])
async def test_a_port_in_use_is_one_clear_line(make):
    async with make({"FIC101": ROLES}) as server:
        with pytest.raises(OSError, match=rf"127\.0\.0\.1:{server.port}$"):
            async with make({"FIC101": ROLES}, port=server.port):
                pass


async def test_a_brokers_port_in_use_is_one_clear_line():
    async with embedded_broker() as port:
        with pytest.raises(OSError, match=rf"127\.0\.0\.1:{port}$"):
            async with embedded_broker(port=port):
                pass


async def test_a_broker_that_is_not_there_is_one_clear_line():
    port = free_port()
    with pytest.raises(OSError, match=rf"127\.0\.0\.1:{port}"):
        async with MqttServer({"FIC101": ROLES}, port=port):
            pass
