"""What a server answers while a connection is opened is no fault of this program."""

import asyncio

import pytest
from asyncua import Client

from connectors.base import ConnectionLostError
from connectors.opcua.connector import connected
from connectors.opcua.options import OpcUaOptions


@pytest.mark.parametrize("error", [AssertionError(), OSError("refused"), TimeoutError()])
def test_a_server_that_opens_no_channel_is_a_lost_connection(monkeypatch, error):
    """asyncua asserts that the answer to a request for a secure channel is one (``ua_client``)."""

    async def connect(_client):
        raise error

    async def scenario():
        async with connected(OpcUaOptions(url="opc.tcp://127.0.0.1:4840")):
            raise NotImplementedError

    monkeypatch.setattr(Client, "connect", connect)
    with pytest.raises(ConnectionLostError, match=r"OPC UA server at opc\.tcp://127\.0\.0\.1:4840: "):
        asyncio.run(scenario())
