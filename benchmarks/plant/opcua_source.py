"""An OPC UA server of a plant, by asyncua: 50 us of a core a value, so it ends before the agent does."""

from __future__ import annotations

import asyncio
import logging
import time
from datetime import UTC, datetime
from multiprocessing.synchronize import Event

from asyncua import Server, ua

from benchmarks.plant.broker import BURSTS
from benchmarks.plant.values import ROLES, values_at


def node(loop: str, role: str) -> str:
    """Return the node of a role."""
    return f"ns=2;s={loop}.{role}"


def serve_opcua(port: int, names: list[str], listens: Event) -> None:
    """Serve OP, PV and SP of the loops; each is measured every second, with its time."""
    logging.getLogger("asyncua").setLevel(logging.CRITICAL)

    async def serve() -> None:
        server = Server()
        await server.init()
        server.set_endpoint(f"opc.tcp://127.0.0.1:{port}")
        server.set_security_policy([ua.SecurityPolicyType.NoSecurity])
        await server.register_namespace("urn:plant")
        nodes = {name: [ua.NodeId.from_string(node(name, role)) for role in ROLES] for name in names}
        for name, of_loop in nodes.items():
            for role, each in zip(ROLES, of_loop, strict=True):
                await server.nodes.objects.add_variable(each, f"2:{name}.{role}", 50.0)
        async with server:
            listens.set()
            started = time.time()
            for k in range(10**9):
                table = values_at(float(k), len(names)).tolist()
                for burst in range(BURSTS):
                    await asyncio.sleep(max(started + k + burst / BURSTS - time.time(), 0.0))
                    now = datetime.now(UTC)
                    for row in range(burst, len(names), BURSTS):
                        for each, value in zip(nodes[names[row]], table[row], strict=True):
                            await server.write_attribute_value(
                                each,
                                ua.DataValue(ua.Variant(value, ua.VariantType.Double), SourceTimestamp=now),
                            )

    asyncio.run(serve())
