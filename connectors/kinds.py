"""The buses slipjump speaks: a new one is one more entry of ``KINDS``.

A bus's library is imported when the first connection of its kind is made: asyncua takes 0.6 s and 40 MB.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

from connectors.base import Connector
from connectors.modbus.options import ModbusOptions, ModbusTag, ModbusTarget
from connectors.modbus.options import short_tag as modbus_tag
from connectors.modbus_server.connector import ModbusServerConnector
from connectors.modbus_server.options import ModbusServerOptions, ModbusServerTarget
from connectors.mqtt.options import MqttOptions, MqttTag, MqttTarget
from connectors.mqtt.options import short_tag as mqtt_tag
from connectors.opcua.options import OpcUaOptions, OpcUaTag, OpcUaTarget
from connectors.opcua.options import short_tag as opcua_tag
from connectors.opcua_server.options import OpcUaServerOptions, OpcUaServerTarget
from connectors.options import LoopTags, NoTag, Options, TagT, Target, TargetT
from connectors.sparkplug.options import SparkplugOptions, SparkplugTarget

OptionsT = TypeVar("OptionsT", bound=Options)
ROLES = ("pv", "op", "sp", "mv", "mode")
"""What a tag can be to its loop."""


@dataclass(frozen=True, slots=True)
class ConnectorKind(Generic[OptionsT, TagT, TargetT]):
    """A bus: the models of its part of the configuration file, and how a connection is made of them."""

    kind: str
    """``kind`` of an entry in ``connections``."""
    options: type[OptionsT]
    """The entry's other keys."""
    tag: type[TagT]
    """One entry of a loop's ``tags``."""
    target: type[TargetT]
    """One entry of a loop's ``publish``."""
    open: Callable[[str, OptionsT, Mapping[str, LoopTags[TagT, TargetT]]], Connector]
    """Connection name, its options, loop name -> what it reads and writes there. Opens nothing yet."""
    roles: tuple[str, ...] = ROLES
    """Keys allowed in a loop's ``tags``; empty where nothing is read from it, with ``NoTag`` as ``tag``."""
    short: Callable[[str], Mapping[str, str]] | None = None
    """Returns an address that is one text, as lists of loops have it, as an entry of ``tags``."""


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


KINDS: tuple[ConnectorKind[Any, Any, Any], ...] = (
    ConnectorKind("modbus", ModbusOptions, ModbusTag, ModbusTarget, _modbus, (*ROLES, "time"), modbus_tag),
    ConnectorKind(
        "modbus_server", ModbusServerOptions, NoTag, ModbusServerTarget, ModbusServerConnector, roles=()
    ),
    ConnectorKind("opcua", OpcUaOptions, OpcUaTag, OpcUaTarget, _opcua, short=opcua_tag),
    ConnectorKind("opcua_server", OpcUaServerOptions, NoTag, OpcUaServerTarget, _opcua_server, roles=()),
    ConnectorKind("mqtt", MqttOptions, MqttTag, MqttTarget, _mqtt, short=mqtt_tag),
    ConnectorKind("sparkplug", SparkplugOptions, NoTag, SparkplugTarget, _sparkplug, roles=()),
)

__all__ = ["KINDS", "ROLES", "ConnectorKind", "LoopTags", "Options", "Target"]
