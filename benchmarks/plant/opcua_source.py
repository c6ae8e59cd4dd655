"""An OPC UA server of a plant that costs next to nothing a value: asyncua's, but for what it publishes.

asyncua's own way from a value that is written to a notification takes 50 us, so it ended with 300 to 1000 loops. Here
nothing is written: when a subscription is due, what was measured since is laid out as bytes by numpy.
"""

from __future__ import annotations

import asyncio
import logging
import time
from multiprocessing.synchronize import Event

import numpy as np
from asyncua import Server, ua
from asyncua.server import subscription_service
from asyncua.server.internal_subscription import InternalSubscription
from numpy.typing import NDArray

from benchmarks.plant.broker import BURSTS
from benchmarks.plant.values import ROLES, values_at

KEPT = 100
"""Seconds of values that a subscription keeps where nobody takes them: the queue of a node, at 1 Hz."""
ENCODING = ua.NodeId(ua.ObjectIds.DataChangeNotification_Encoding_DefaultBinary)
VALUE_AND_SOURCE_TIME = 0x05
DOUBLE = 11
"""Part 6: the mask of a DataValue, and the type of its Variant."""
EPOCH, TICKS = 11_644_473_600, 10_000_000
"""s from 1601 to 1970; ticks a second."""
ITEM = np.dtype(
    [("handle", "<u4"), ("mask", "u1"), ("kind", "u1"), ("value", "<f8"), ("source_time", "<i8")]
)
"""A MonitoredItemNotification, as it is on the wire."""


def node(loop: str, role: str) -> str:
    """Return the node of a role."""
    return f"ns=2;s={loop}.{role}"


class _Measured(InternalSubscription):
    """A subscription whose values are measured when they are asked for, each with its time."""

    _handles: NDArray[np.uint32]
    _places: NDArray[np.intp]
    """Of each item: the number of its loop, times the roles, and its role."""
    _taken = -1
    """Number of the last burst that was sent; of all since 1970."""
    places: dict[ua.NodeId, int]
    """By node; the same for all."""

    def has_published_results(self) -> bool:
        """Whether there is a new burst, or it must say that it is alive."""
        watched = bool(self.monitored_item_srv._monitored_items)  # noqa: SLF001 - asyncua has no way in
        return (watched and _burst_now() > self._taken) or super().has_published_results()

    def _pop_triggered_datachanges(self, result: ua.PublishResult) -> None:
        self._triggered_datachanges = {}
        now = _burst_now()
        first = max(self._taken + 1, now - KEPT * BURSTS) if self._taken >= 0 else now
        self._taken = now
        self._know_items()
        blocks = [self._block(burst) for burst in range(first, now + 1)]
        count = sum(map(len, blocks))
        if count:
            body = b"".join((_int32(count), *(each.tobytes() for each in blocks), _int32(-1)))
            result.NotificationMessage.NotificationData.append(ua.ExtensionObject(ENCODING, body))

    def _know_items(self) -> None:
        items = self.monitored_item_srv._monitored_items.values()  # noqa: SLF001
        if hasattr(self, "_handles") and len(self._handles) == len(items):
            return
        there = [each for each in items if each.read_value_id.NodeId in self.places]
        self._handles = np.array([each.client_handle for each in there], np.uint32)
        self._places = np.array([self.places[each.read_value_id.NodeId] for each in there], np.intp)

    def _block(self, burst: int) -> NDArray[np.void]:
        """Return what is measured in a burst: a part of the loops."""
        mine = (self._places // len(ROLES)) % BURSTS == burst % BURSTS
        block = np.zeros(int(mine.sum()), ITEM)
        table = values_at(float(burst // BURSTS), len(self.places) // len(ROLES)).ravel()
        block["handle"], block["value"] = self._handles[mine], table[self._places[mine]]
        block["mask"], block["kind"] = VALUE_AND_SOURCE_TIME, DOUBLE
        block["source_time"] = round((burst / BURSTS + EPOCH) * TICKS)
        return block

    async def stop(self) -> None:
        """End at once: asyncua looks through all items for each that it deletes."""
        self.monitored_item_srv._monitored_items.clear()  # noqa: SLF001
        await super().stop()


def _burst_now() -> int:
    return int(time.time() * BURSTS)


def _int32(number: int) -> bytes:
    return number.to_bytes(4, "little", signed=True)


def serve_opcua(port: int, names: list[str], listens: Event) -> None:
    """Serve OP, PV and SP of the loops; each is measured every second, with its time."""
    logging.getLogger("asyncua").setLevel(logging.CRITICAL)
    nodes = [(name, role) for name in names for role in ROLES]
    _Measured.places = {ua.NodeId.from_string(node(*each)): k for k, each in enumerate(nodes)}
    subscription_service.InternalSubscription = _Measured  # type: ignore[misc]

    async def serve() -> None:
        server = Server()
        await server.init()
        server.set_endpoint(f"opc.tcp://127.0.0.1:{port}")
        server.set_security_policy([ua.SecurityPolicyType.NoSecurity])
        await server.register_namespace("urn:plant")
        for (name, role), each in zip(nodes, _Measured.places, strict=True):
            await server.nodes.objects.add_variable(each, f"2:{name}.{role}", 50.0)
        async with server:
            listens.set()
            await asyncio.Event().wait()

    asyncio.run(serve())
