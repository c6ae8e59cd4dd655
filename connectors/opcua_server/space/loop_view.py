"""One loop as clients see it: what is published of it, and how its alarm stands."""

from __future__ import annotations

from datetime import UTC, datetime

from asyncua import Server, ua

from connectors.base import JsonValue, Publication
from connectors.opcua.values import variant
from connectors.opcua_server.alarm.condition import Condition
from connectors.opcua_server.alarm.event_fields import event_fields
from connectors.opcua_server.alarm.events import Events
from connectors.opcua_server.space.loop_nodes import BANDS, VARIABLES, add_alarm, add_loop
from connectors.opcua_server.space.names import Names


class LoopView:
    """Shows one loop; adds its nodes when made."""

    def __init__(
        self, server: Server, names: Names, events: Events, condition: Condition, longest_shelving: float
    ) -> None:
        """Prepare it.

        Args:
            server: Where it is shown.
            names: Node ids of the server.
            events: Sends them.
            condition: The loop and where its alarm stood when it was last shown.
            longest_shelving: s.
        """
        self.condition = condition
        self._server = server
        self._names = names
        self._events = events
        self._told: dict[str, JsonValue] = {}
        self._longest_shelving = longest_shelving

    async def build(self, unit: str | None) -> None:
        """Add the nodes; ``unit`` is that of OP."""
        loop = self.condition.loop
        add_loop(self._server, self._names, loop, unit)
        add_alarm(self._server, self._names, loop, self._fields())
        waiting = ua.StatusCode(ua.StatusCodes.BadWaitingForInitialData)
        for name in VARIABLES:
            await self._server.write_attribute_value(
                self._names.variable(loop, name), ua.DataValue(None, waiting)
            )

    async def show(self, publication: Publication) -> None:
        """Show a publication: the variables of a state, and what it means to the alarm."""
        self._told = dict(publication.fields)
        if publication.kind == "state":
            await self._write_variables()
        await self.change(self.condition.after(publication))

    async def change(self, condition: Condition) -> None:
        """Let the alarm be as ``condition`` says; sent as an event where that is new."""
        is_new = condition != self.condition
        self.condition = condition
        fields, names = self._fields(), self._names
        here, loop = names.condition(condition.loop), names.loop(condition.loop)
        for path, value in fields.items():
            node = names.of(f"{here.Identifier}.{path.replace('/', '.')}")
            shown = ua.DataValue(value, SourceTimestamp=fields["Time"].Value)
            await self._server.write_attribute_value(node, shown)
        if is_new:
            self._events.retain(here, loop, fields)
            await self._events.tell(here, loop, fields)

    def _fields(self) -> dict[str, ua.Variant]:
        return event_fields(self._names, self.condition, self._told, self._longest_shelving)

    async def _write_variables(self) -> None:
        time = self._told.get("time")
        stamp = datetime.fromtimestamp(time, UTC) if isinstance(time, int | float) else datetime.now(UTC)
        for name, (field, kind) in VARIABLES.items():
            value = self._told.get(field)
            shown = None if value is None and kind is not ua.VariantType.String else variant(value, kind)
            code = ua.StatusCodes.BadNoData if shown is None else ua.StatusCodes.Good
            if name in BANDS and shown is not None and self._told.get("verdict") != "stiction":
                code = ua.StatusCodes.UncertainLastUsableValue  # an earlier window found it
            await self._server.write_attribute_value(
                self._names.variable(self.condition.loop, name),
                ua.DataValue(shown, ua.StatusCode(code), SourceTimestamp=stamp),
            )
