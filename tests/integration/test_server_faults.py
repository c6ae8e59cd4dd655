"""A port in use or a broker that is not there is one clear line, on each bus."""

import socket

import pytest

from simulators.servers.broker import embedded_broker
from simulators.servers.modbus import ModbusServer
from simulators.servers.mqtt import MqttServer
from simulators.servers.opcua import OpcUaServer

LOOPS = {"FIC1": ("pv", "op")}


@pytest.fixture
def taken():
    """A port that somebody else listens on."""
    with socket.create_server(("127.0.0.1", 0)) as listener:
        yield listener.getsockname()[1]


@pytest.fixture
def free():
    """A port that nobody listens on."""
    with socket.create_server(("127.0.0.1", 0)) as listener:
        return listener.getsockname()[1]


@pytest.mark.parametrize("server", [ModbusServer, OpcUaServer])
async def test_a_port_in_use(server, taken):
    with pytest.raises(OSError, match=f"cannot listen on 127.0.0.1:{taken}$"):
        async with server(LOOPS, port=taken):
            pass


async def test_a_port_in_use_by_another_broker(taken):
    with pytest.raises(OSError, match=f"cannot listen on 127.0.0.1:{taken}$"):
        async with embedded_broker(port=taken):
            pass


async def test_a_broker_that_is_not_there(free):
    with pytest.raises(OSError, match=f"127.0.0.1:{free}"):
        async with MqttServer(LOOPS, port=free):
            pass
