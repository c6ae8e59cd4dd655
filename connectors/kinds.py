"""The buses slipjump speaks: a new one is one more entry of ``KINDS``."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

from connectors.base import Connector
from connectors.modbus.connector import ModbusConnector
from connectors.modbus.options import ModbusOptions, ModbusTag, ModbusTarget
from connectors.modbus.options import short_tag as modbus_tag
from connectors.modbus_server.connector import ModbusServerConnector
from connectors.modbus_server.options import ModbusServerOptions, ModbusServerTarget
from connectors.mqtt.connector import MqttConnector
from connectors.mqtt.options import MqttOptions, MqttTag, MqttTarget
from connectors.mqtt.options import short_tag as mqtt_tag
from connectors.opcua.connector import OpcUaConnector
from connectors.opcua.options import OpcUaOptions, OpcUaTag, OpcUaTarget
from connectors.opcua.options import short_tag as opcua_tag
from connectors.opcua_server.connector import OpcUaServerConnector
from connectors.opcua_server.options import OpcUaServerOptions, OpcUaServerTarget
from connectors.options import LoopTags, NoTag, Options, TagT, Target, TargetT
from connectors.sparkplug.connector import SparkplugConnector
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


KINDS: tuple[ConnectorKind[Any, Any, Any], ...] = (
    ConnectorKind(
        "modbus", ModbusOptions, ModbusTag, ModbusTarget, ModbusConnector, (*ROLES, "time"), modbus_tag
    ),
    ConnectorKind(
        "modbus_server", ModbusServerOptions, NoTag, ModbusServerTarget, ModbusServerConnector, roles=()
    ),
    ConnectorKind("opcua", OpcUaOptions, OpcUaTag, OpcUaTarget, OpcUaConnector, short=opcua_tag),
    ConnectorKind(
        "opcua_server", OpcUaServerOptions, NoTag, OpcUaServerTarget, OpcUaServerConnector, roles=()
    ),
    ConnectorKind("mqtt", MqttOptions, MqttTag, MqttTarget, MqttConnector, short=mqtt_tag),
    ConnectorKind("sparkplug", SparkplugOptions, NoTag, SparkplugTarget, SparkplugConnector, roles=()),
)

__all__ = ["KINDS", "ROLES", "ConnectorKind", "LoopTags", "Options", "Target"]
