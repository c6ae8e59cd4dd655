"""An OPC UA server of a plant that costs next to nothing a value: asyncua's, but for what it publishes.

asyncua's own way from a value that is written to a notification takes 50 us, so it ended with 300 to 1000
loops. Here nothing is written: when a subscription is due, what was measured since is laid out as bytes by
numpy. Nodes can be watched, not read.
"""

from __future__ import annotations

import asyncio
import logging
import time
from collections.abc import Mapping
from multiprocessing.synchronize import Event
from typing import Any

import numpy as np
from asyncua import Server, ua
from asyncua.server import subscription_service
from asyncua.server.address_space import AddressSpace
from asyncua.server.internal_subscription import InternalSubscription
from asyncua.server.monitored_item_service import MonitoredItemService
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
ITEM = np.dtype([("handle", "<u4"), ("mask", "u1"), ("kind", "u1"), ("value", "<f8"), ("source_time", "<i8")])
"""A MonitoredItemNotification, as it is on the wire."""


def node(loop: str, role: str) -> str:
    """Return the node of a role."""
    return f"ns=2;s={loop}.{role}"


class _Items(MonitoredItemService):
    """What a subscription watches; in an address space of asyncua 30,000 nodes take minutes."""

    places: Mapping[ua.NodeId, int]
    """Of each node: the number of its loop, times the roles, and its role; the same for all."""

    def __init__(self, subscription: InternalSubscription, space: AddressSpace) -> None:
        super().__init__(subscription, space)
        self._handles, self._places = list[int](), list[int]()

    async def create_monitored_items(
        self, params: ua.CreateMonitoredItemsParameters
    ) -> list[ua.MonitoredItemCreateResult]:
        """Watch nodes from the next burst on."""
        return [self._created(item) for item in params.ItemsToCreate]

    def _created(self, item: ua.MonitoredItemCreateRequest) -> ua.MonitoredItemCreateResult:
        result = ua.MonitoredItemCreateResult()
        place = self.places.get(item.ItemToMonitor.NodeId)
        if place is None:
            result.StatusCode = ua.StatusCode(ua.StatusCodes.BadNodeIdUnknown)
            return result
        self._handles.append(item.RequestedParameters.ClientHandle)
        self._places.append(place)
        result.MonitoredItemId = len(self._handles)
        result.RevisedQueueSize = item.RequestedParameters.QueueSize
        return result

    def __len__(self) -> int:
        return len(self._handles)

    def arrays(self) -> tuple[NDArray[np.uint32], NDArray[np.intp]]:
        """Return the client's handle and the place of each."""
        return np.array(self._handles, np.uint32), np.array(self._places, np.intp)


class _Measured(InternalSubscription):
    """A subscription whose values are measured when they are published, each with its time."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:  # noqa: ANN401 - asyncua's
        super().__init__(*args, **kwargs)
        self.monitored_item_srv = self._items = _Items(self, self.monitored_item_srv.aspace)
        self._handles, self._places = self._items.arrays()
        self._sent = _burst_now()
        """Number of the last burst that was sent, of all since 1970."""

    def has_published_results(self) -> bool:
        """Whether there is a new burst, or it must say that it is alive."""
        return (len(self._items) > 0 and _burst_now() > self._sent) or super().has_published_results()

    def _pop_triggered_datachanges(self, result: ua.PublishResult) -> None:
        if len(self._items) > len(self._handles):
            self._handles, self._places = self._items.arrays()
        now = _burst_now()
        first, self._sent = max(self._sent + 1, now + 1 - KEPT * BURSTS), now
        blocks = [self._block(burst) for burst in range(first, now + 1)]
        count = sum(map(len, blocks))
        if count:
            body = b"".join((_int32(count), *(each.tobytes() for each in blocks), _int32(-1)))
            result.NotificationMessage.NotificationData.append(ua.ExtensionObject(ENCODING, body))

    def _block(self, burst: int) -> NDArray[np.void]:
        """Return what is measured in a burst: a part of the loops."""
        mine = (self._places // len(ROLES)) % BURSTS == burst % BURSTS
        block = np.zeros(int(mine.sum()), ITEM)
        table = values_at(float(burst // BURSTS), len(self._items.places) // len(ROLES)).ravel()
        block["handle"], block["value"] = self._handles[mine], table[self._places[mine]]
        block["mask"], block["kind"] = VALUE_AND_SOURCE_TIME, DOUBLE
        block["source_time"] = round((burst / BURSTS + EPOCH) * TICKS)
        return block


def _burst_now() -> int:
    return int(time.time() * BURSTS)


def _int32(number: int) -> bytes:
    return number.to_bytes(4, "little", signed=True)


def serve_opcua(port: int, names: list[str], listens: Event) -> None:
    """Serve OP, PV and SP of the loops; each is measured every second, with its time."""
    logging.getLogger("asyncua").setLevel(logging.CRITICAL)
    nodes = [(name, role) for name in names for role in ROLES]
    _Items.places = {ua.NodeId.from_string(node(*each)): k for k, each in enumerate(nodes)}
    subscription_service.InternalSubscription = _Measured  # type: ignore[misc]

    async def serve() -> None:
        server = Server()
        await server.init()
        server.set_endpoint(f"opc.tcp://127.0.0.1:{port}")
        server.set_security_policy([ua.SecurityPolicyType.NoSecurity])
        await server.register_namespace("urn:plant")
        async with server:
            listens.set()
            await asyncio.Event().wait()

    asyncio.run(serve())
