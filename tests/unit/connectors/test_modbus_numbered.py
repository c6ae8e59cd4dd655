"""Several reads are under way on one connection, and each gets its own answer."""

import asyncio
import struct
from contextlib import asynccontextmanager

import pytest

from connectors.base import ConnectionLostError
from connectors.modbus.client import DeviceError, connected
from connectors.modbus.connector import ModbusConnector
from connectors.modbus.numbered import NUMBERS
from connectors.modbus.options import ModbusOptions, ModbusTag
from connectors.options import LoopTags

DEADLINE = 10.0
"""Longest time for anything that must happen, s."""
SHORT, LONG = 0.2, 30.0
"""A timeout that is waited for, and one that must not pass, s."""


class Device:
    """Keeps requests until a test answers them."""

    def __init__(self):
        self.requests = asyncio.Queue()
        self.writer = None
        self.most = self.waiting = 0

    async def serve(self, reader, writer):
        self.writer = writer
        while head := await reader.read(12):
            self.waiting += 1
            self.most = max(self.most, self.waiting)
            number, _, _, unit, function, address, count = struct.unpack(">HHHBBHH", head)
            await self.requests.put((number, unit, function, address, count))

    def answer(self, request, *, number=None, function=None, body=None):
        """Answer a read with the address of each register, or with what the test wants."""
        asked, unit, code, address, count = request
        self.waiting -= 1
        registers = struct.pack(f">{count}H", *range(address, address + count))
        pdu = bytes([unit, function or code]) + (
            bytes([len(registers)]) + registers if body is None else body
        )
        self.send(struct.pack(">HHH", asked if number is None else number, 0, len(pdu)) + pdu)

    def send(self, data):
        self.writer.write(data)


@asynccontextmanager
async def device():
    made = Device()
    server = await asyncio.start_server(made.serve, "127.0.0.1", 0)
    try:
        yield made, server.sockets[0].getsockname()[1]
    finally:
        server.close()
        if made.writer is not None:
            made.writer.close()


@asynccontextmanager
async def reading(wait=LONG, requests=4):
    async with device() as (made, port), connected(_options(port, wait, requests)) as client:
        yield made, client


def _options(port, wait, requests):
    return ModbusOptions(port=port, timeout=wait, requests=requests)


async def within(work):
    async with asyncio.timeout(DEADLINE):
        return await work


async def test_answers_in_another_order_go_to_their_requests():
    async with reading() as (there, client):
        reads = [asyncio.create_task(client.read("holding", 10 * k, 3)) for k in range(4)]
        requests = [await within(there.requests.get()) for _ in reads]
        assert {number for number, *_ in requests} <= set(NUMBERS)
        for request in reversed(requests):
            there.answer(request)
        for k, read in enumerate(reads):
            assert list(await within(read)) == [10 * k, 10 * k + 1, 10 * k + 2]


async def test_an_answer_in_pieces_and_two_in_one_piece():
    async with reading() as (there, client):
        reads = [asyncio.create_task(client.read("input", 5 * k, 2)) for k in range(2)]
        requests = [await within(there.requests.get()) for _ in reads]
        sent = []
        there.send = sent.append
        for request in requests:
            there.answer(request)
        data = b"".join(sent)
        for piece in (data[:1], data[1:4], data[4:8], data[8:]):
            there.writer.write(piece)
            await there.writer.drain()
            await asyncio.sleep(0)
        assert [list(await within(read)) for read in reads] == [[0, 1], [5, 6]]


async def test_a_refusal_is_that_of_its_request_alone():
    async with reading() as (there, client):
        reads = [asyncio.create_task(client.read("holding", k, 1)) for k in range(2)]
        first, second = [await within(there.requests.get()) for _ in reads]
        there.answer(first, function=0x83, body=b"\x02")
        there.answer(second)
        with pytest.raises(DeviceError, match="no such address"):
            await within(reads[0])
        assert list(await within(reads[1])) == [1]


async def test_a_late_answer_is_not_taken_for_another():
    async with reading(SHORT) as (there, client):
        with pytest.raises(ConnectionLostError, match=r"no answer within 0\.2 s"):
            await within(client.read("holding", 7, 1))
        assert client.silent
        late = await within(there.requests.get())
        again = asyncio.create_task(client.read("holding", 9, 1))
        request = await within(there.requests.get())
        there.answer(late)
        there.answer(request)
        assert list(await within(again)) == [9]


@pytest.mark.parametrize(
    "wrong",
    [
        {"body": b"\x02\x00"},
        {"body": b"\x04\x00\x01\x00\x02"},
        {"body": b"\x02\x00\x01\x00"},
        {"function": 4},
    ],
)
async def test_a_wrong_answer_is_a_loss_at_once(wrong):
    async with reading() as (there, client):
        read = asyncio.create_task(client.read("holding", 0, 1))
        there.answer(await within(there.requests.get()), **wrong)
        with pytest.raises(ConnectionLostError):
            await within(read)
        assert not client.silent


@pytest.mark.parametrize("garbage", [b"HTTP/1.1 400 Bad Request\r\n", struct.pack(">HHH", 1, 0, 9999)])
async def test_garbage_ends_all_that_wait_at_once(garbage):
    async with reading() as (there, client):
        reads = [asyncio.create_task(client.read("holding", k, 1)) for k in range(3)]
        for _ in reads:
            await within(there.requests.get())
        there.send(garbage)
        for read in reads:
            with pytest.raises(ConnectionLostError, match="not Modbus"):
                await within(read)


async def test_a_device_that_hangs_up_ends_all_that_wait_at_once():
    async with reading() as (there, client):
        reads = [asyncio.create_task(client.read("holding", k, 1)) for k in range(3)]
        for _ in reads:
            await within(there.requests.get())
        there.writer.close()
        for read in reads:
            with pytest.raises(ConnectionLostError, match="closed the connection"):
                await within(read)
        with pytest.raises(ConnectionLostError, match="closed"):
            await within(client.read("holding", 0, 1))


async def test_a_write_goes_on_beside_reads():
    async with reading() as (there, client):
        read = asyncio.create_task(client.read("holding", 3, 1))
        asked = await within(there.requests.get())
        write = asyncio.create_task(client.write_coil(5, value=True))
        number, _, function, address, value = await within(there.requests.get())
        assert (function, address, value) == (5, 5, 0xFF00)
        assert number not in NUMBERS
        there.send(struct.pack(">HHHBBHH", number, 0, 6, 1, 5, 5, 0xFF00))
        await within(write)
        there.answer(asked)
        assert list(await within(read)) == [3]


@pytest.mark.parametrize(("connections", "requests"), [(1, 1), (1, 3)])
async def test_as_many_requests_are_under_way_as_the_options_allow(connections, requests):
    loops = {
        f"L{k}": LoopTags({"pv": ModbusTag(table="input", address=100 * k, type="uint16")}, [])
        for k in range(6)
    }
    async with device() as (there, port):
        options = ModbusOptions(port=port, timeout=LONG, connections=connections, requests=requests)
        async with ModbusConnector("plc", options, loops).session() as session:
            samples = session.samples()

            async def read():
                return {(each.tag.loop, each.value) for each in [await anext(samples) for _ in range(6)]}

            reading_all = asyncio.create_task(read())
            for _ in range(6 // requests):
                held = [await within(there.requests.get()) for _ in range(requests)]
                assert there.requests.empty()
                for each in reversed(held):
                    there.answer(each)
            assert await within(reading_all) == {(f"L{k}", 100.0 * k) for k in range(6)}
            await samples.aclose()
    assert there.most == requests


async def test_writing_to_a_device_that_has_hung_up_is_a_loss():
    async with reading() as (there, client):
        read = asyncio.create_task(client.read("holding", 0, 1))
        await within(there.requests.get())
        there.writer.close()
        with pytest.raises(ConnectionLostError):
            await within(read)
        with pytest.raises(ConnectionLostError):
            await within(client.write_coil(5, value=True))


async def test_one_request_at_a_time_holds_for_reads_and_writes_together():
    async with reading(requests=1) as (there, client):
        read = asyncio.create_task(client.read("holding", 3, 1))
        asked = await within(there.requests.get())
        write = asyncio.create_task(client.write_coil(5, value=True))
        again = asyncio.create_task(client.read("holding", 4, 1))
        await asyncio.sleep(0)
        there.answer(asked)
        assert list(await within(read)) == [3]
        number, *_ = await within(there.requests.get())
        assert there.requests.empty()
        there.send(struct.pack(">HHHBBHH", number, 0, 6, 1, 5, 5, 0xFF00))
        await within(write)
        there.answer(await within(there.requests.get()))
        assert list(await within(again)) == [4]


async def test_each_of_several_waits_as_long_as_its_own_timeout():
    clock = asyncio.get_running_loop()
    async with reading(wait=SHORT) as (there, client):

        async def silent():
            began = clock.time()
            with pytest.raises(ConnectionLostError, match=f"no answer within {SHORT:g} s"):
                await client.read("input", 1, 1)
            return clock.time() - began

        for _ in range(2):  # the second time on a connection whose former waits have ended
            first = asyncio.create_task(silent())
            answered = asyncio.create_task(client.read("input", 2, 1))
            await within(there.requests.get())
            there.answer(await within(there.requests.get()))
            assert tuple(await within(answered)) == (2,)
            await asyncio.sleep(SHORT / 2)
            second = asyncio.create_task(silent())
            waited = [await within(first), await within(second)]
            assert all(each >= SHORT for each in waited)
            await within(there.requests.get())
