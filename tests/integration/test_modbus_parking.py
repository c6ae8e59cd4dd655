"""What gives no answer holds up nothing else: one block of a device, one unit behind a gateway."""

import asyncio
import contextlib
import struct

import pytest
from buses import connector_of

from connectors.base import ConnectionLostError, LoopRole, Quality
from connectors.checks import Reader
from connectors.checks.session import until
from connectors.modbus import block_reader, parking

UNREACHABLE = 11
TAGS = {
    "FIC101": {"pv": {"table": "input", "address": 0}, "op": {"table": "input", "address": 2}},
    "FIC102": {"pv": {"table": "input", "address": 100}, "op": {"table": "input", "address": 102}},
}
POLL, TIMEOUT, PROBE = 0.01, 0.2, 0.3


class Device:
    """Answers every request for input registers with 1.5 but where it is told not to, one after the other."""

    def __init__(self):
        self.silent = set()
        """Addresses that get no answer."""
        self.slow = set()
        """Addresses that get one too late; all else on that connection waits."""
        self.unreachable = False
        self.asked = []
        """Addresses."""
        self.most_connections = 9
        self._serving = set()

    async def __aenter__(self):
        self._server = await asyncio.start_server(self._serve, "127.0.0.1", 0)
        self.port = self._server.sockets[0].getsockname()[1]
        return self

    async def __aexit__(self, *_):
        self._server.close()
        for task in self._serving:
            task.cancel()
        if self._serving:
            await asyncio.wait(self._serving)

    async def _serve(self, reader, writer):
        if sum(not task.done() for task in self._serving) >= self.most_connections:
            writer.close()
            return
        self._serving.add(asyncio.current_task())
        with contextlib.suppress(ConnectionError, asyncio.CancelledError), contextlib.closing(writer):
            while request := await reader.read(12):
                number, _, _, unit, function, address, count = struct.unpack(">HHHBBHH", request)
                self.asked.append(address)
                if address in self.silent:
                    continue
                if address in self.slow:
                    await asyncio.sleep(3 * TIMEOUT)
                pdu = struct.pack(">BB", function, 2 * count) + (count * struct.pack(">f", 1.5))[: 2 * count]
                if self.unreachable:
                    pdu = struct.pack(">BB", function | 0x80, UNREACHABLE)
                writer.write(struct.pack(">HHHB", number, 0, 1 + len(pdu), unit) + pdu)

    def connector(self):
        loops = [{"name": name, "tags": tags, "publish": []} for name, tags in TAGS.items()]
        return connector_of(
            {"kind": "modbus", "port": self.port, "poll": POLL, "timeout": TIMEOUT},
            loops,
        )


@pytest.fixture(autouse=True)
def _probe_often(monkeypatch):
    for module in (parking, block_reader):
        monkeypatch.setattr(module, "PROBE", PROBE)


async def lost(connector):
    """What a session reads until it is lost."""
    async with connector.session() as session, Reader(session) as reading:
        with pytest.raises(ConnectionLostError):
            await reading.end(30)
    return reading


def good(reading, loop):
    return [sample for sample in reading.of(LoopRole(loop, "pv")) if sample.quality is Quality.GOOD]


async def test_a_silent_block_is_requested_apart_while_the_others_are_read(caplog):
    async with Device() as device:
        device.silent = {100}
        with caplog.at_level("INFO"):
            async with device.connector().session() as session, Reader(session) as reading:
                await until(lambda: device.asked.count(100) >= 4)
                polls = len(good(reading, "FIC101"))
                missing = reading.of(LoopRole("FIC102", "pv"))
                assert {sample.why for sample in missing} == {"no answer within 0.2 s"}
                assert polls > 2 * device.asked.count(100)
                device.silent = set()
                await until(lambda: good(reading, "FIC102"))
        told = [record.message for record in caplog.records if "input 100 to 103" in record.message]
        assert len(told) == 2
        assert "no answer within 0.2 s" in told[0]
        assert "answers again" in told[1]


async def test_on_a_device_that_allows_one_connection_it_is_requested_on_that(caplog):
    async with Device() as device:
        device.silent, device.most_connections = {100}, 1
        with caplog.at_level("INFO"):
            async with device.connector().session() as session, Reader(session) as reading:
                await until(lambda: device.asked.count(100) >= 3)
                polls = len(good(reading, "FIC101"))
                assert polls > 2 * device.asked.count(100)
                device.silent = set()
                await until(lambda: good(reading, "FIC102"))
    assert len([record for record in caplog.records if "input 100 to 103" in record.message]) == 2


async def test_a_block_that_holds_up_its_connection_is_left_out_of_the_next():
    async with Device() as device:
        device.slow = {100}
        connector = device.connector()
        await lost(connector)
        async with connector.session() as session, Reader(session) as reading:
            await until(
                lambda: len(good(reading, "FIC101")) >= 20 and len(reading.of(LoopRole("FIC102", "pv"))) >= 20
            )
            assert good(reading, "FIC102") == []
            device.slow = set()
            await until(lambda: good(reading, "FIC102"))


async def test_a_device_that_is_silent_as_a_whole_is_lost():
    async with Device() as device:
        device.silent = {0, 100}
        connector = device.connector()
        assert (await lost(connector)).samples == []
        device.silent = set()
        async with connector.session() as session, Reader(session) as reading:
            await until(lambda: good(reading, "FIC101") and good(reading, "FIC102"))


async def test_a_unit_that_its_gateway_cannot_reach_is_requested_now_and_then():
    async with Device() as device:
        device.unreachable = True
        async with device.connector().session() as session, Reader(session) as reading:
            await until(lambda: len(device.asked) >= 3)
            bad = reading.of(LoopRole("FIC102", "pv"))
            assert {(sample.quality, sample.code) for sample in bad} == {(Quality.BAD, UNREACHABLE)}
            assert len(bad) > 2 * len(device.asked)
            device.unreachable = False
            await until(lambda: good(reading, "FIC101") and good(reading, "FIC102"))
