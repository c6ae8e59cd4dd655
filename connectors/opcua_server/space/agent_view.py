"""The agent as clients see it, as far as its publications show."""

from __future__ import annotations

from collections.abc import Iterable
from datetime import UTC, datetime

from asyncua import Server, ua

from connectors.opcua_server.alarm.condition import Condition
from connectors.opcua_server.space.names import Names
from connectors.opcua_server.space.nodes import add_object, add_variable

_VARIABLES = {
    "Loops": ua.VariantType.UInt32,
    "ActiveAlarms": ua.VariantType.UInt32,
    "UnacknowledgedAlarms": ua.VariantType.UInt32,
    "Orders": ua.VariantType.UInt32,
    "LastMessage": ua.VariantType.DateTime,
}


class AgentView:
    """Shows how many loops and alarms there are, and when the agent published something last."""

    def __init__(self, server: Server, names: Names) -> None:
        """Add the nodes."""
        self._server = server
        self._nodes = {name: names.of(f"/Agent.{name}") for name in _VARIABLES}
        here = names.of("/Agent")
        add_object(server, names.folder, here, names.browse("Agent"))
        for name, kind in _VARIABLES.items():
            add_variable(
                server,
                here,
                self._nodes[name],
                names.browse(name),
                ua.Variant(ua.get_default_value(kind), kind),
            )

    async def show(self, conditions: Iterable[Condition], orders: int, *, published: bool = True) -> None:
        """Show where all alarms stand and the orders taken; ``published``: a message came just now."""
        all_of_them, now = tuple(conditions), datetime.now(UTC)
        values: dict[str, int | datetime | None] = {
            "Loops": len(all_of_them),
            "ActiveAlarms": sum(condition.active for condition in all_of_them),
            "UnacknowledgedAlarms": sum(not condition.acked for condition in all_of_them),
            "Orders": orders,
            "LastMessage": now if published else None,
        }
        for name, value in values.items():
            waits = ua.StatusCode(ua.StatusCodes.BadWaitingForInitialData)
            shown = ua.Variant(value, _VARIABLES[name])
            data = ua.DataValue(None, waits) if value is None else ua.DataValue(shown, SourceTimestamp=now)
            await self._server.write_attribute_value(self._nodes[name], data)
