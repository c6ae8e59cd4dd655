"""Filters of events: as asyncua's, but that a type includes its subtypes (Part 4, 7.7.3).

asyncua 2.1 compares the type alone; a client that selects every AlarmConditionType would get none of ours.
"""

from __future__ import annotations

from typing import Any

from asyncua import ua
from asyncua.server.address_space import AddressSpace

from connectors.opcua_server.asyncua_private import FilterEvaluator


class Where(FilterEvaluator):
    """One filter."""

    def evaluate(self, index: int, event: Any) -> Any:  # noqa: ANN401 - asyncua's own
        """Return the value of the ``index``-th element; OfType also holds for subtypes."""
        element = self.elements[index]
        if element.FilterOperator == ua.FilterOperator.OfType:
            wanted = self.operand(element.FilterOperands[0], event)
            return wanted in supertypes(self.space, event.EventType)
        return super().evaluate(index, event)


def supertypes(space: AddressSpace, kind: ua.NodeId) -> list[ua.NodeId]:
    """Return a type and all above it."""
    found, subtype = [kind], ua.NodeId(ua.ObjectIds.HasSubtype)
    while (node := space.get(found[-1])) is not None:
        above = [r.NodeId for r in node.references if r.ReferenceTypeId == subtype and not r.IsForward]
        if not above or above[0] in found:
            break
        found.append(above[0])
    return found
