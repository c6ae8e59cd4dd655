"""Clients that send garbage to our own servers: counted or answered, told once, no order, no harm."""

import asyncio
import contextlib
import gc
import random
import struct
from contextlib import asynccontextmanager

import pytest
from asyncua import Client
from pymodbus.client import AsyncModbusTcpClient

from connectors.modbus_server.connector import ModbusServerConnector
from connectors.modbus_server.options import ModbusServerOptions, ModbusServerTarget
from connectors.opcua_server.connector import OpcUaServerConnector
from connectors.opcua_server.options import OpcUaServerOptions, OpcUaServerTarget
from connectors.options import LoopTags
from tests.faults.opcua_talk import SESSION, Talk
from tests.ports import free_port

OFTEN = pytest.mark.parametrize(
    "times",
    [
        pytest.param(40, marks=pytest.mark.timeout(240)),
        pytest.param(10_000, marks=[pytest.mark.bench, pytest.mark.timeout(3600)]),
    ],
)


def garbled(chance, frame):
    """Bytes of any kind, or a frame cut short, or one with some bytes changed."""
    kind = chance.randrange(3)
    if kind == 0:
        return chance.randbytes(chance.randint(1, 300))
    if kind == 1:
        return frame[: chance.randrange(1, len(frame))]
    changed = bytearray(frame)
    for _ in range(chance.randint(1, 4)):
        changed[chance.randrange(len(frame))] ^= chance.randrange(1, 256)
    return bytes(changed)


@asynccontextmanager
async def served(connector, caplog):
    """The session of a server, which must neither crash nor take an order meanwhile, and tell of garbage."""
    escaped, orders = [], []
    asyncio.get_running_loop().set_exception_handler(lambda _, context: escaped.append(context))
    async with connector.session() as session:

        async def listen():
            orders.extend([each async for each in session.samples()])

        listening = asyncio.create_task(listen())
        try:
            yield session
            assert not listening.done()
        finally:
            listening.cancel()
            await asyncio.wait({listening})
    gc.collect()
    assert (escaped, orders) == ([], [])
    said = [each.message for each in caplog.records if each.name == "connectors.malformed"]
    assert 1 <= len(said) == len(set(said)) <= 3


REQUESTS = tuple(
    struct.pack(">HHHB", 7, 0, len(pdu) + 1, 1) + pdu
    for pdu in (
        b"\x03\x00\x00\x00\x08",
        b"\x02\x00\x00\x00\x10",
        b"\x06\x00\x00\x00\x01",
        b"\x10\x00\x00\x00\x01\x02\x00\x01",
    )
)


@OFTEN
async def test_garbage_at_the_modbus_server(times, caplog):
    chance = random.Random(7)
    loops = {name: LoopTags({}, [ModbusServerTarget(connection="s")]) for name in ("FIC1", "LIC2")}
    options = ModbusServerOptions(orders=True).model_copy(update={"port": 0})
    connector = ModbusServerConnector("s", options, loops)
    async with served(connector, caplog) as session:
        for _ in range(times):
            before = connector.malformed
            reader, writer = await asyncio.open_connection("127.0.0.1", session.port)
            said = b""
            with contextlib.suppress(ConnectionError):
                writer.write(sent := garbled(chance, chance.choice(REQUESTS)))
                writer.write_eof()
                async with asyncio.timeout(30):
                    said = await reader.read()
            writer.close()
            no_request = len(said) == 9 and said[7] >= 0x80 and said[8] != 2
            assert (said and not no_request) or connector.malformed > before, sent
        async with asyncio.timeout(30):
            client = AsyncModbusTcpClient("127.0.0.1", port=session.port, timeout=30, retries=0)
            assert await client.connect()
            assert (await client.read_holding_registers(0, count=3)).registers[0::2] == [1, 2]
            client.close()


def does_not_end(frame):
    """Whether an OPC UA server must wait for more."""
    if len(frame) < 8 or frame[3:4] == b"C":
        return True
    return struct.unpack_from("<I", frame, 4)[0] > len(frame)


@OFTEN
async def test_garbage_at_the_opc_ua_server(times, caplog):
    chance, port = random.Random(7), free_port()
    loops = {"FIC1": LoopTags({}, [OpcUaServerTarget(connection="s")])}
    connector = OpcUaServerConnector("s", OpcUaServerOptions(port=port, anonymous="read"), loops)
    async with served(connector, caplog):
        talk = None
        for _ in range(times):
            talk, goal = talk or await Talk.to(port), chance.choice((*range(SESSION), SESSION, SESSION))
            while talk.at < goal:
                await talk.go_on()
            sent, before = garbled(chance, talk.message()), connector.malformed
            if does_not_end(sent):
                await talk.stop(sent)
                said = None
            elif (said := await talk.say(sent)) is None or talk.at < SESSION:
                await talk.stop()
            assert said or connector.malformed > before, sent
            if said is None or talk.at < SESSION:
                talk = None
        if talk is not None:
            await talk.stop()
        async with Client(f"opc.tcp://127.0.0.1:{port}", timeout=30) as client:
            assert (await client.nodes.server.read_browse_name()).Name == "Server"
