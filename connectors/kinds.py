"""The registered buses: those built in and those of installed packages (docs/howto/own_connector.md).

A bus's library is imported when the first connection of its kind is made: asyncua takes 0.6 s and 40 MB.
"""

from __future__ import annotations

from collections.abc import Mapping
from importlib.metadata import entry_points
from typing import Any

from connectors.base import Connector
from connectors.kind import ROLES, ConnectorKind
from connectors.modbus.options import ModbusOptions, ModbusTag, ModbusTarget
from connectors.modbus.options import short_tag as modbus_tag
from connectors.modbus_server.connector import ModbusServerConnector
from connectors.modbus_server.options import ModbusServerOptions, ModbusServerTarget
from connectors.mqtt.options import MqttOptions, MqttTag, MqttTarget
from connectors.mqtt.options import short_tag as mqtt_tag
from connectors.opcua.options import OpcUaOptions, OpcUaTag, OpcUaTarget
from connectors.opcua.options import short_tag as opcua_tag
from connectors.opcua_server.options import OpcUaServerOptions, OpcUaServerTarget
from connectors.options import LoopTags, NoTag, Options, Target
from connectors.sparkplug.options import SparkplugOptions, SparkplugTarget


def _modbus(
    name: str, options: ModbusOptions, loops: Mapping[str, LoopTags[ModbusTag, ModbusTarget]]
) -> Connector:
    from connectors.modbus.connector import ModbusConnector

    return ModbusConnector(name, options, loops)


def _opcua(
    name: str, options: OpcUaOptions, loops: Mapping[str, LoopTags[OpcUaTag, OpcUaTarget]]
) -> Connector:
    from connectors.opcua.connector import OpcUaConnector

    return OpcUaConnector(name, options, loops)


def _opcua_server(
    name: str, options: OpcUaServerOptions, loops: Mapping[str, LoopTags[NoTag, OpcUaServerTarget]]
) -> Connector:
    from connectors.opcua_server.connector import OpcUaServerConnector

    return OpcUaServerConnector(name, options, loops)


def _mqtt(name: str, options: MqttOptions, loops: Mapping[str, LoopTags[MqttTag, MqttTarget]]) -> Connector:
    from connectors.mqtt.connector import MqttConnector

    return MqttConnector(name, options, loops)


def _sparkplug(
    name: str, options: SparkplugOptions, loops: Mapping[str, LoopTags[NoTag, SparkplugTarget]]
) -> Connector:
    from connectors.sparkplug.connector import SparkplugConnector

    return SparkplugConnector(name, options, loops)


BUILT_IN: tuple[ConnectorKind[Any, Any, Any], ...] = (
    ConnectorKind("modbus", ModbusOptions, ModbusTag, ModbusTarget, _modbus, (*ROLES, "time"), modbus_tag),
    ConnectorKind(
        "modbus_server",
        ModbusServerOptions,
        NoTag,
        ModbusServerTarget,
        ModbusServerConnector,
        roles=(),
        listens=True,
    ),
    ConnectorKind("opcua", OpcUaOptions, OpcUaTag, OpcUaTarget, _opcua, short=opcua_tag),
    ConnectorKind(
        "opcua_server", OpcUaServerOptions, NoTag, OpcUaServerTarget, _opcua_server, roles=(), listens=True
    ),
    ConnectorKind("mqtt", MqttOptions, MqttTag, MqttTarget, _mqtt, short=mqtt_tag),
    ConnectorKind("sparkplug", SparkplugOptions, NoTag, SparkplugTarget, _sparkplug, roles=()),
)
ENTRY_POINTS = "slipjump.connectors"
"""Group under which an installed package offers a ``ConnectorKind``."""


def _installed() -> tuple[ConnectorKind[Any, Any, Any], ...]:
    """Return the kinds of installed packages; raises ValueError where a name is taken."""
    known = {each.kind: each for each in BUILT_IN}
    for entry in entry_points(group=ENTRY_POINTS):
        own: ConnectorKind[Any, Any, Any] = entry.load()
        if own.kind in known:
            raise ValueError(f"{entry.value} offers a connector of kind {own.kind!r}, which exists already")
        known[own.kind] = own
    return tuple(known.values())[len(BUILT_IN) :]


KINDS: tuple[ConnectorKind[Any, Any, Any], ...] = (*BUILT_IN, *_installed())
"""All of them. Each is checked by ``connectors.checks`` in tests/contracts/test_connector_kinds.py."""

__all__ = ["BUILT_IN", "ENTRY_POINTS", "KINDS", "ROLES", "ConnectorKind", "LoopTags", "Options", "Target"]
