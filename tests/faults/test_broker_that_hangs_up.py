"""A broker that hangs up before it lets a client in, or at the same moment, is lost at once."""

import asyncio
import gc

import pytest

from connectors.base import ConnectionLostError
from connectors.mqtt.client import connected
from connectors.mqtt.options import MqttOptions

WELCOME = b"\x20\x02\x00\x00"
"""CONNACK of MQTT 3.1.1: accepted."""


async def listened(options):
    async with asyncio.timeout(10), connected(options) as client:
        async for _ in client.messages:
            pass


@pytest.mark.parametrize("answer", [b"", WELCOME[:1], WELCOME], ids=["none", "half of one", "welcome"])
async def test_it_is_reported_and_no_exception_is_left_over(answer):
    async def hang_up(reader, writer):
        await reader.read(1000)
        writer.write(answer)
        writer.close()

    escaped = []
    asyncio.get_running_loop().set_exception_handler(lambda _, context: escaped.append(context))
    server = await asyncio.start_server(hang_up, "127.0.0.1", 0)
    options = MqttOptions(port=server.sockets[0].getsockname()[1], timeout=60.0, keepalive=60)
    for _ in range(10):
        with pytest.raises(ConnectionLostError):
            await listened(options)
    server.close()
    gc.collect()
    assert escaped == []
