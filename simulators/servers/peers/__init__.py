"""Peers of the connectors built in, for ``connectors.checks``: kind -> factory.

A kind of another package brings its own as ``ConnectorKind.peers``. Libraries of buses are imported with the
first peer of a kind.
"""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import AbstractAsyncContextManager
from typing import Any

from connectors.checks.peer import Peer, PeerFactory
from connectors.kind import ConnectorKind

__all__ = ["PEERS", "peers_of"]


def _modbus() -> AbstractAsyncContextManager[Peer]:
    from simulators.servers.peers.modbus import ModbusPeer  # noqa: PLC0415

    return ModbusPeer()


def _modbus_server() -> AbstractAsyncContextManager[Peer]:
    from simulators.servers.peers.modbus_server import ModbusServerPeer  # noqa: PLC0415

    return ModbusServerPeer()


def _opcua() -> AbstractAsyncContextManager[Peer]:
    from simulators.servers.peers.opcua import OpcUaPeer  # noqa: PLC0415

    return OpcUaPeer()


def _opcua_server() -> AbstractAsyncContextManager[Peer]:
    from simulators.servers.peers.opcua_server import OpcUaServerPeer  # noqa: PLC0415

    return OpcUaServerPeer()


def _mqtt() -> AbstractAsyncContextManager[Peer]:
    from simulators.servers.peers.mqtt import MqttPeer  # noqa: PLC0415

    return MqttPeer()


def _sparkplug() -> AbstractAsyncContextManager[Peer]:
    from simulators.servers.peers.sparkplug import SparkplugPeer  # noqa: PLC0415

    return SparkplugPeer()


PEERS: Mapping[str, PeerFactory] = {
    "modbus": _modbus,
    "modbus_server": _modbus_server,
    "opcua": _opcua,
    "opcua_server": _opcua_server,
    "mqtt": _mqtt,
    "sparkplug": _sparkplug,
}


def peers_of(kind: ConnectorKind[Any, Any, Any]) -> PeerFactory:
    """Return the factory of a kind's peers; raises LookupError where it has none."""
    factory = kind.peers or PEERS.get(kind.kind)
    if factory is None:
        raise LookupError(f"kind {kind.kind!r} has no peers: without them nothing can check it")
    return factory
