"""Plants on OPC UA: every value a node with source time and status, alarms back into writable nodes."""

from __future__ import annotations

import logging
import math
from collections.abc import AsyncIterator, Mapping, Sequence
from datetime import UTC, datetime
from typing import Self

from asyncua import Client, Server, ua
from asyncua.common.subscription import DataChangeEvent

from connectors.opcua_server.asyncua_private import client_sessions
from simulators.plant import Row
from simulators.servers.loop_server import ALARM_FIELDS, Entry, loop_entry

logging.getLogger("asyncua").setLevel(
    logging.CRITICAL
)  # a client that comes and goes is not worth a log line

PUBLISHING_INTERVAL = 0.05
"""Of readers and watchers, s of wall time."""
QUEUE = 200


class OpcUaServer:
    """A server with the nodes ``ns=2;s=LOOP.PV``, ``.OP`` and so on; the alarm is ``LOOP.STICTION``."""

    name = "opcua"
    lead = QUEUE // 2

    def __init__(self, loops: Mapping[str, Sequence[str]], host: str = "127.0.0.1", port: int = 0) -> None:
        """Prepare to serve ``loops``, each with its roles; port 0 takes any that is free."""
        self._roles = loops
        self._host = host
        self.port = port
        self._server: Server

    async def __aenter__(self) -> Self:
        """Listen; raises OSError."""
        self._server = Server()
        await self._server.init()
        self._server.set_endpoint(f"opc.tcp://{self._host}:{self.port}")
        self._server.set_security_policy([ua.SecurityPolicyType.NoSecurity])
        index = await self._server.register_namespace("urn:slipjump:plants")
        for loop, roles in self._roles.items():
            await self._add_nodes(index, loop, roles)
        try:
            await self._server.start()
        except OSError as error:
            raise OSError(f"OPC UA server: cannot listen on {self._host}:{self.port}") from error
        self.port = self._server.bserver.port
        return self

    async def __aexit__(self, *_: object) -> None:
        """Stop to listen and drop every client."""
        await self._server.stop()
        for session in client_sessions(self._server.iserver):
            await session.close_session()  # asyncua keeps those whose client has vanished, with their tasks

    async def put(self, loop: str, row: Row) -> None:
        """Show this row. NaN becomes a bad status, as of a failed sensor."""
        stamp = datetime.fromtimestamp(row.time, UTC)
        for role in self._roles[loop]:
            value = row.values[role]
            missing = not isinstance(value, str) and math.isnan(value)
            status = ua.StatusCodes.BadSensorFailure if missing else ua.StatusCodes.Good
            kind = ua.VariantType.String if role == "mode" else ua.VariantType.Double
            await self._server.write_attribute_value(
                ua.NodeId.from_string(node_of(loop, role)),
                ua.DataValue(
                    None if missing else ua.Variant(value, kind),
                    ua.StatusCode(status),
                    SourceTimestamp=stamp,
                ),
            )

    def connection_settings(self) -> Entry:
        """Return the entry of ``connections``."""
        url = f"opc.tcp://{self._host}:{self.port}"
        return {"kind": "opcua", "url": url, "publishing_interval": PUBLISHING_INTERVAL, "queue": QUEUE}

    def loop_settings(self, loop: str, ts: float) -> Entry:
        """Return the entry of ``loops``."""
        tags = {role: {"node": node_of(loop, role)} for role in self._roles[loop]}
        fields = {field: {"node": node_of(loop, f"stiction.{field}")} for field in (*ALARM_FIELDS, "state")}
        active = {"node": node_of(loop, "stiction")}
        return loop_entry(self.name, loop, ts, tags, {"active": active, "fields": fields})

    async def watch_alarms(self) -> AsyncIterator[tuple[str, bool]]:
        """Yield (loop, active) from a subscription of its own client."""
        loops = {ua.NodeId.from_string(node_of(loop, "stiction")): loop for loop in self._roles}
        async with Client(f"opc.tcp://{self._host}:{self.port}") as client:
            changes = await client.create_subscription(1000 * PUBLISHING_INTERVAL)
            await changes.subscribe_data_change([client.get_node(node) for node in loops])
            async for event in changes:
                if isinstance(event, DataChangeEvent):
                    yield loops[event.node.nodeid], bool(event.value)

    async def _add_nodes(self, index: int, loop: str, roles: Sequence[str]) -> None:
        folder = await self._server.nodes.objects.add_object(ua.NodeId(loop, index), f"{index}:{loop}")
        waiting = ua.StatusCode(ua.StatusCodes.BadWaitingForInitialData)
        for role in roles:
            kind = ua.VariantType.String if role == "mode" else ua.VariantType.Double
            node = ua.NodeId.from_string(node_of(loop, role))
            value = ua.Variant("" if role == "mode" else math.nan, kind)
            await folder.add_variable(node, f"{index}:{role.upper()}", value)
            await self._server.write_attribute_value(node, ua.DataValue(None, waiting))
        alarm: dict[str, ua.Variant] = {
            "stiction": ua.Variant(False, ua.VariantType.Boolean),
            "stiction.state": ua.Variant("", ua.VariantType.String),
            **{f"stiction.{field}": ua.Variant(math.nan, ua.VariantType.Double) for field in ALARM_FIELDS},
        }
        for name, value in alarm.items():
            node = ua.NodeId.from_string(node_of(loop, name))
            variable = await folder.add_variable(node, f"{index}:{name.upper()}", value)
            await variable.set_writable()


def node_of(loop: str, name: str) -> str:
    """Return the node of a role or of a part of the alarm, e.g. ``ns=2;s=FIC101.PV``."""
    return f"ns=2;s={loop}.{name.upper()}"
