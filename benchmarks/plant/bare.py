"""Bare clients: each reads the plant with the library of its bus alone, and makes numbers of what comes."""

from __future__ import annotations

import asyncio
import json
import logging
import math
import struct
import time
from collections.abc import Sequence
from multiprocessing.connection import Connection

import aiomqtt
from asyncua import Client, ua
from asyncua.common.node import Node
from pymodbus.client import AsyncModbusTcpClient

from benchmarks.plant.marks import answer
from benchmarks.plant.modbus_source import REGISTERS
from benchmarks.plant.opcua_source import node
from benchmarks.plant.values import ROLES

MOST_REGISTERS = 125
MONITORED = 500
"""Nodes of one request."""
PATIENT = 60.0
"""Longest wait for the server, s: on a machine that others use asyncua's own guard ends the connection."""
QUEUE = 100
"""Values that the server keeps of a node, as for the agent."""


class _Count:
    """Values that came."""

    def __init__(self) -> None:
        self.values = 0

    def answering(self, says: Connection) -> asyncio.Task[None]:
        """Answer marks of the parent meanwhile."""
        return asyncio.create_task(answer(says, self.count))

    async def count(self) -> dict[str, int]:
        """Return how many came."""
        return {"": self.values}


def mqtt(port: int, _: Sequence[str], says: Connection) -> None:
    """Receive each message, parse its numbers."""

    async def read() -> None:
        count = _Count()
        async with aiomqtt.Client("127.0.0.1", port) as client:
            await client.subscribe("plant/#", qos=1)
            answering = count.answering(says)
            async for message in client.messages:
                tree = json.loads(message.payload)
                count.values += sum(math.isfinite(float(tree[role])) for role in ROLES)
                if answering.done():
                    return

    asyncio.run(read())


def modbus(port: int, names: Sequence[str], says: Connection) -> None:
    """Read all registers every second, as many loops in a request as it has room for."""
    width = len(ROLES) * REGISTERS
    most = MOST_REGISTERS // width * width
    last = len(names) * width

    async def read() -> None:
        count = _Count()
        client = AsyncModbusTcpClient("127.0.0.1", port=port)
        await client.connect()
        answering = count.answering(says)
        due = time.monotonic()
        while not answering.done():
            for first in range(0, last, most):
                size = min(most, last - first)
                registers = (await client.read_holding_registers(first, count=size)).registers
                numbers = struct.unpack(f">{size // REGISTERS}f", struct.pack(f">{size}H", *registers))
                count.values += sum(map(math.isfinite, numbers))
            due = max(due + 1.0, time.monotonic())
            await asyncio.sleep(due - time.monotonic())
        client.close()

    asyncio.run(read())


def opcua(port: int, names: Sequence[str], says: Connection) -> None:
    """Subscribe to all nodes, also to values that are measured again and the same."""
    logging.getLogger("asyncua").setLevel(logging.CRITICAL)
    count = _Count()

    class Handler:
        def datachange_notification(self, _node: Node, value: float, _data: object) -> None:
            count.values += math.isfinite(float(value))

    async def read() -> None:
        url = f"opc.tcp://127.0.0.1:{port}"
        async with Client(url, timeout=PATIENT, watchdog_intervall=PATIENT) as client:
            subscription = await client.create_subscription(500, Handler())
            nodes = [client.get_node(node(name, role)) for name in names for role in ROLES]
            changed = ua.DataChangeFilter(Trigger=ua.DataChangeTrigger.StatusValueTimestamp)
            items = [_item(each, changed, k) for k, each in enumerate(nodes, start=1)]
            for first in range(0, len(items), MONITORED):
                await subscription.create_monitored_items(items[first : first + MONITORED])
            await count.answering(says)

    asyncio.run(read())


def _item(watched: Node, changed: ua.DataChangeFilter, handle: int) -> ua.MonitoredItemCreateRequest:
    parameters = ua.MonitoringParameters(handle, 0.0, changed, QUEUE, DiscardOldest=True)
    what = ua.ReadValueId(watched.nodeid, ua.AttributeIds.Value)
    return ua.MonitoredItemCreateRequest(what, ua.MonitoringMode.Reporting, parameters)
