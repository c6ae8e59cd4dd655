"""Adds nodes to the address space; only what is needed, where asyncua would copy whole types."""

from __future__ import annotations

from typing import Any

from asyncua import Server, ua

_READ = ua.AccessLevel.CurrentRead.mask
_HAS = ua.NodeAttributesMask
_OF_OBJECT = _HAS.DisplayName | _HAS.EventNotifier
_OF_VARIABLE = (
    _HAS.DisplayName
    | _HAS.Value
    | _HAS.DataType
    | _HAS.ValueRank
    | _HAS.AccessLevel
    | _HAS.UserAccessLevel
    | _HAS.Historizing
)
"""What Part 3 requires of a node and no more: asyncua takes as long for each attribute that says nothing."""
_DATA_TYPES = {
    ua.VariantType.LocalizedText: ua.ObjectIds.LocalizedText,
    ua.VariantType.StatusCode: ua.ObjectIds.StatusCode,
    ua.VariantType.DateTime: ua.ObjectIds.UtcTime,
    ua.VariantType.ExtensionObject: ua.ObjectIds.EUInformation,
}
"""Where the data type is another than the built-in one of the same number."""


def add_object(
    server: Server,
    parent: ua.NodeId,
    node: ua.NodeId,
    name: ua.QualifiedName,
    *,
    kind: ua.NodeId | None = None,
    reference: int = ua.ObjectIds.HasComponent,
    notifies: bool = False,
) -> None:
    """Add an object of type ``kind``; ``notifies`` where clients may subscribe to its events."""
    attributes = ua.ObjectAttributes(EventNotifier=1 if notifies else 0)
    attributes.SpecifiedAttributes = _OF_OBJECT  # it cannot be said when it is made
    kind = kind or ua.NodeId(ua.ObjectIds.BaseObjectType)
    _add(server, parent, node, name, ua.NodeClass.Object, kind, reference, attributes)


def add_type(server: Server, above: ua.NodeId, node: ua.NodeId, name: ua.QualifiedName) -> None:
    """Add a type of objects below another."""
    subtype, attributes = ua.ObjectIds.HasSubtype, ua.ObjectTypeAttributes()
    _add(server, above, node, name, ua.NodeClass.ObjectType, ua.NodeId(), subtype, attributes)


def add_variable(
    server: Server,
    parent: ua.NodeId,
    node: ua.NodeId,
    name: ua.QualifiedName,
    value: ua.Variant,
    *,
    kind: int = ua.ObjectIds.BaseDataVariableType,
    reference: int = ua.ObjectIds.HasComponent,
    data_type: ua.NodeId | None = None,
) -> None:
    """Add a variable that clients can read and nobody can write."""
    attributes = ua.VariableAttributes(
        Value=value,
        DataType=data_type or ua.NodeId(_DATA_TYPES.get(value.VariantType, value.VariantType.value)),
        ValueRank=ua.ValueRank.OneDimension if value.is_array else ua.ValueRank.Scalar,
        AccessLevel=_READ,
        UserAccessLevel=_READ,
        SpecifiedAttributes=_OF_VARIABLE,
    )
    _add(server, parent, node, name, ua.NodeClass.Variable, ua.NodeId(kind), reference, attributes)


def add_property(
    server: Server, parent: ua.NodeId, node: ua.NodeId, name: ua.QualifiedName, value: ua.Variant
) -> None:
    """Add a property."""
    kind, reference = ua.ObjectIds.PropertyType, ua.ObjectIds.HasProperty
    add_variable(server, parent, node, name, value, kind=kind, reference=reference)


def add_reference(server: Server, source: ua.NodeId, kind: int, target: ua.NodeId) -> None:
    """Let a node point to another; the way back is not shown, since a type's method serves all objects."""
    item = ua.AddReferencesItem(SourceNodeId=source, ReferenceTypeId=ua.NodeId(kind), TargetNodeId=target)
    for status in server.iserver.node_mgt_service.add_references([item]):
        status.check()


def _add(
    server: Server,
    parent: ua.NodeId,
    node: ua.NodeId,
    name: ua.QualifiedName,
    node_class: ua.NodeClass,
    kind: ua.NodeId,
    reference: int,
    attributes: Any,  # noqa: ANN401 - asyncua has a class for each class of nodes, without a common one
) -> None:
    attributes.DisplayName = ua.LocalizedText(name.Name)
    item = ua.AddNodesItem(
        ParentNodeId=parent,
        ReferenceTypeId=ua.NodeId(reference),
        RequestedNewNodeId=node,
        BrowseName=name,
        NodeClass=node_class,
        TypeDefinition=kind,
        NodeAttributes=attributes,
    )
    for result in server.iserver.node_mgt_service.add_nodes([item]):
        result.StatusCode.check()
