"""A peer that answers with garbage and hangs up: each time one loss that is told, and nothing else."""

import asyncio
import gc
import random
import struct
from contextlib import asynccontextmanager

import pytest

from connectors.base import ConnectionLostError, Quality
from tests.faults.peer import LOOPS, TS
from tests.faults.rig import SERVERS
from tests.integration.buses import connector_of

MBAP = struct.pack(">HHHBBB", 1, 0, 31, 1, 4, 28) + bytes(28)
"""A Modbus answer: 14 input registers."""
CONNACK = b"\x20\x02\x00\x00"
SUBACK = b"\x90\x03\x00\x01\x01"
PUBLISH = b"\x32\x1c\x00\x0cplant/FIC101\x00\x07" + b'{"t": 1, "p'
ACKNOWLEDGE = b"ACKF" + struct.pack("<IIIIII", 28, 0, 65535, 65535, 0, 0)
"""OPC UA's answer to Hello."""
OPEN = b"OPNF" + struct.pack("<II", 132, 1) + bytes(124)
FRAMES = {
    "modbus": (MBAP,),
    "mqtt": (CONNACK, CONNACK + SUBACK, CONNACK + SUBACK + PUBLISH),
    "opcua": (ACKNOWLEDGE, ACKNOWLEDGE + OPEN),
}
HEADER = {"modbus": 9, "mqtt": 40, "opcua": 40}
"""First bytes, any of which may be changed; later ones of Modbus are values, where all is allowed."""
TIMEOUT = {"modbus": 60.0, "mqtt": 0.1, "opcua": 60.0}
"""s; only MQTT waits for it, the others tell at once."""


def garbage(bus, chance):
    """Bytes of any kind, or a frame with some of its first ones changed, or cut short."""
    kind = chance.randrange(3)
    if kind == 0:
        return chance.randbytes(chance.randint(1, 300))
    frame = bytearray(chance.choice(FRAMES[bus]))
    if kind == 1:
        return bytes(frame[: chance.randrange(1, len(frame))])
    for _ in range(chance.randint(1, 4)):
        frame[chance.randrange(min(len(frame), HEADER[bus]))] ^= chance.randrange(1, 256)
    return bytes(frame)


@asynccontextmanager
async def babbler(bus):
    """A server that answers each client's first words with garbage and hangs up; yields its port."""
    chance = random.Random(7)

    async def answer(reader, writer):
        await reader.read(4096)
        writer.write(garbage(bus, chance))
        writer.close()

    server = await asyncio.start_server(answer, "127.0.0.1", 0)
    try:
        yield server.sockets[0].getsockname()[1]
    finally:
        server.close()


async def heard(connector):
    """What a session reads until it is lost."""
    samples = []
    with pytest.raises(ConnectionLostError):
        async with asyncio.timeout(30), connector.session() as session:
            samples += [each async for each in session.samples()]
    return samples


@pytest.mark.parametrize("bus", FRAMES)
@pytest.mark.parametrize(
    "times",
    [
        pytest.param(40, marks=pytest.mark.timeout(240)),
        pytest.param(10_000, marks=[pytest.mark.bench, pytest.mark.timeout(3600)]),
    ],
)
async def test_garbage_is_a_loss_and_never_a_value(bus, times):
    escaped = []
    asyncio.get_running_loop().set_exception_handler(lambda _, context: escaped.append(context))
    async with babbler(bus) as port:
        server = SERVERS[bus](LOOPS, port=port)
        connection = {**server.connection_settings(), "timeout": TIMEOUT[bus]}
        connector = connector_of(connection, [server.loop_settings("FIC101", TS)])
        for _ in range(times):
            assert {each.quality for each in await heard(connector)} <= {Quality.BAD}
    gc.collect()
    assert escaped == []
