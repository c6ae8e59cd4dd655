"""Nodes of one loop: an object with variables, and its alarm with a variable for each field of its events."""

from __future__ import annotations

from collections.abc import Mapping

from asyncua import Server, ua

from connectors.opcua_server.alarm.event_fields import OWN_FIELDS
from connectors.opcua_server.space.names import Names
from connectors.opcua_server.space.nodes import (
    add_object,
    add_property,
    add_reference,
    add_type,
    add_variable,
)

VARIABLES: dict[str, tuple[str, ua.VariantType]] = {
    "Active": ("active", ua.VariantType.Boolean),
    "State": ("state", ua.VariantType.String),
    "Verdict": ("verdict", ua.VariantType.String),
    "S": ("s", ua.VariantType.Double),
    "J": ("j", ua.VariantType.Double),
    "FS": ("f_s", ua.VariantType.Double),
    "FD": ("f_d", ua.VariantType.Double),
    "Priority": ("priority", ua.VariantType.String),
    "NE107": ("ne107", ua.VariantType.String),
    "DeviceHealth": ("health", ua.VariantType.UInt32),
    "Time": ("time", ua.VariantType.DateTime),
    "By": ("by", ua.VariantType.String),
    "Until": ("until", ua.VariantType.DateTime),
    "ActivationId": ("id", ua.VariantType.String),
    "MessageId": ("message_id", ua.VariantType.String),
    "Sequence": ("sequence", ua.VariantType.Int64),
}
"""Browse name -> field of the publication, type."""
BANDS = ("S", "J", "FS", "FD")
HEALTH = ("NORMAL", "FAILURE", "CHECK_FUNCTION", "OFF_SPEC", "MAINTENANCE_REQUIRED")
"""Words of DeviceHealthEnumeration of OPC UA Part 100, in the order of its numbers."""
PERCENT = 20529
"""UNECE code P1, as Part 8, 5.6.4.3 packs it into a number."""
COMMANDS = (
    ua.ObjectIds.AcknowledgeableConditionType_Acknowledge,
    ua.ObjectIds.ConditionType_AddComment,
    ua.ObjectIds.AlarmConditionType_RemoveFromService,
    ua.ObjectIds.AlarmConditionType_PlaceInService,
    ua.ObjectIds.AlarmConditionType_RemoveFromService2,
    ua.ObjectIds.AlarmConditionType_PlaceInService2,
)
SHELVING_COMMANDS = (
    ua.ObjectIds.ShelvedStateMachineType_TimedShelve,
    ua.ObjectIds.ShelvedStateMachineType_Unshelve,
    ua.ObjectIds.ShelvedStateMachineType_TimedShelve2,
    ua.ObjectIds.ShelvedStateMachineType_Unshelve2,
)


_KINDS = {
    **dict.fromkeys(("Quality", "LastSeverity", "Comment"), ua.ObjectIds.ConditionVariableType),
    **dict.fromkeys(
        ("EnabledState", "AckedState", "ActiveState", "SuppressedState", "OutOfServiceState"),
        ua.ObjectIds.TwoStateVariableType,
    ),
    "CurrentState": ua.ObjectIds.FiniteStateVariableType,
}
"""Fields that are variables of a type of their own; all others are properties."""


def add_alarm_type(server: Server, names: Names) -> None:
    """Add our type of alarm: OffNormalAlarmType and what slipjump knows beyond it."""
    here = names.alarm_type
    add_type(server, ua.NodeId(ua.ObjectIds.OffNormalAlarmType), here, names.browse("StictionAlarmType"))
    for name, kind in OWN_FIELDS.items():
        node = _below(here, name)
        add_property(server, here, node, names.browse(name), ua.Variant(ua.get_default_value(kind), kind))
        add_reference(
            server, node, ua.ObjectIds.HasModellingRule, ua.NodeId(ua.ObjectIds.ModellingRule_Mandatory)
        )


def add_loop(server: Server, names: Names, loop: str, unit: str | None) -> None:
    """Add a loop's object and variables.

    Args:
        server: Where.
        names: Its node ids.
        loop: Name.
        unit: Of OP; None: no unit.
    """
    here = names.loop(loop)
    add_object(server, names.folder, here, names.browse(loop), notifies=True)
    add_reference(server, names.folder, ua.ObjectIds.HasNotifier, here)
    for name, (_, kind) in VARIABLES.items():
        node, of_kind = names.variable(loop, name), ua.ObjectIds.BaseDataVariableType
        if name in BANDS and unit is not None:
            of_kind = ua.ObjectIds.BaseAnalogType
        if name == "DeviceHealth":
            of_kind = ua.ObjectIds.MultiStateDiscreteType
        add_variable(
            server, here, node, names.browse(name), ua.Variant(ua.get_default_value(kind), kind), kind=of_kind
        )
        if of_kind == ua.ObjectIds.BaseAnalogType and unit is not None:
            _add_property(
                server, node, "EngineeringUnits", ua.Variant(_unit(unit), ua.VariantType.ExtensionObject)
            )
        if of_kind == ua.ObjectIds.MultiStateDiscreteType:
            words = [ua.LocalizedText(word) for word in HEALTH]
            _add_property(server, node, "EnumStrings", ua.Variant(words, ua.VariantType.LocalizedText))


def add_alarm(server: Server, names: Names, loop: str, fields: Mapping[str, ua.Variant]) -> None:
    """Add the instance of a loop's condition. Its methods are those of the type, which serve all."""
    here, shelving, ids = names.condition(loop), names.shelving(loop), ua.ObjectIds
    add_object(server, names.loop(loop), here, names.browse("Alarm"), kind=names.alarm_type)
    add_reference(server, names.loop(loop), ids.HasCondition, here)
    machine = ua.NodeId(ids.ShelvedStateMachineType)
    add_object(server, here, shelving, ua.QualifiedName("ShelvingState"), kind=machine)
    for parent, methods in ((here, COMMANDS), (shelving, SHELVING_COMMANDS)):
        for method in methods:
            add_reference(server, parent, ids.HasComponent, ua.NodeId(method))
    for path, value in fields.items():
        *above, last = path.split("/")
        parent = names.of(".".join([str(here.Identifier), *above]))
        name = names.browse(last) if path in OWN_FIELDS else ua.QualifiedName(last)
        kind = _KINDS.get(last)
        if kind is None:
            add_property(server, parent, _below(parent, last), name, value)
        else:
            add_variable(server, parent, _below(parent, last), name, value, kind=kind)


def _add_property(server: Server, parent: ua.NodeId, name: str, value: ua.Variant) -> None:
    add_property(server, parent, _below(parent, name), ua.QualifiedName(name), value)


def _below(parent: ua.NodeId, name: str) -> ua.NodeId:
    return ua.NodeId(f"{parent.Identifier}.{name}", parent.NamespaceIndex)


def _unit(text: str) -> ua.EUInformation:
    percent = text == "%"
    return ua.EUInformation(
        NamespaceUri="http://www.opcfoundation.org/UA/units/un/cefact" if percent else "urn:slipjump:units",
        UnitId=PERCENT if percent else -1,
        DisplayName=ua.LocalizedText(text),
        Description=ua.LocalizedText("percent" if percent else text),
    )
