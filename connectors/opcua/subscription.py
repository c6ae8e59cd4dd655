"""A subscription that says so when it dies.

asyncua's own guard recreates a silent subscription by itself and can lose its nodes while doing so. Therefore
the subscription is made without the client's knowledge, and whoever reads it gets an error when it is dead.
Its queue has an object, and its ``next_event`` a task, for each value; here a notification stays one piece.
"""

from __future__ import annotations

import asyncio
import logging
import math
import time
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

from asyncua import Client, ua
from asyncua.client.ua_session import UaSession
from asyncua.common.subscription import Subscription

from connectors.base import ConnectionLostError
from connectors.opcua.asyncua_private import publish_fast
from connectors.opcua.batches import Batches
from connectors.opcua.notification import NodeChanges, NodeValue, ValueBlock
from connectors.opcua.options import OpcUaOptions
from connectors.opcua.values import change_of

_LOG = logging.getLogger(__name__)
WAITING, WAITING_OF_EACH = 10_000, 10
"""Values that may wait to be read at least, and of each node: ten seconds of values at 1 Hz."""
_LIFETIME = 60.0
"""How long the server keeps a subscription that nobody reads, s."""
_NO_FILTER = (
    ua.StatusCodes.BadFilterNotAllowed,
    ua.StatusCodes.BadMonitoredItemFilterInvalid,
    ua.StatusCodes.BadMonitoredItemFilterUnsupported,
)


class NodeReport(NamedTuple):
    """Values of nodes, in the order in which they came."""

    nodes: list[str]
    values: ValueBlock | list[NodeValue]


class _Notifications(Subscription):  # type: ignore[misc]
    """Gives the data of each notification as they came."""

    def __init__(
        self, session: UaSession, wanted: ua.CreateSubscriptionParameters, take: Callable[[list[Any]], None]
    ) -> None:
        super().__init__(session, wanted)
        self._take = take

    async def publish_callback(self, publish_result: ua.PublishResult) -> None:
        """Take the answer to a publish request; one without data says that the server is alive."""
        self.last_publish_at = time.monotonic()
        message = publish_result.NotificationMessage
        if message.NotificationData is not None:
            self.last_sequence_number = int(message.SequenceNumber)
            self._take(message.NotificationData)


class NodeSubscription:
    """Changes of many nodes; made by ``subscription``."""

    def __init__(
        self, session: UaSession, wanted: ua.CreateSubscriptionParameters, options: OpcUaOptions
    ) -> None:
        self._subscription = _Notifications(session, wanted, self._take)
        self._session = session
        self._options = options
        self._silence = math.inf
        self._created = time.monotonic()
        self._nodes: dict[int, str] = {}
        """By client handle; one that is watched anew has another one."""
        self._waiting: list[NodeReport] = []
        self._came = asyncio.Event()
        self._ended = False
        self.lost = 0
        """Values that were discarded because too many waited."""
        self._reads, self._creates = Batches(), Batches()

    async def init(self) -> None:
        """Have the server create it."""
        granted = await self._subscription.init()
        alive = granted.RevisedPublishingInterval / 1000 * granted.RevisedMaxKeepAliveCount
        self._silence = alive + self._options.timeout

    async def add(self, nodes: Sequence[str]) -> dict[str, ua.StatusCode]:
        """Watch ``nodes``; return those the server does not have, with what it said."""
        # with this trigger a value that was measured again and is the same counts too
        changed = ua.DataChangeFilter(Trigger=ua.DataChangeTrigger.StatusValueTimestamp)
        refused = await self._monitor(nodes, changed)
        plain = [node for node, status in refused.items() if status.value in _NO_FILTER]
        return {node: status for node, status in refused.items() if node not in plain} | await self._monitor(
            plain, None
        )

    async def read(self, nodes: Sequence[str]) -> dict[str, ua.DataValue]:
        """Read the values of ``nodes``, reported or not."""
        answers = await self._reads.ask(self._values, [ua.NodeId.from_string(node) for node in nodes])
        return dict(zip(nodes, answers, strict=True))

    async def changes(self, timeout: float) -> list[NodeReport]:  # noqa: ASYNC109 - not to be cancelled
        """Return all changes that wait, oldest first; none came for ``timeout`` s: an empty list.

        Raises:
            ConnectionLostError: The subscription is dead.
        """
        if not self._waiting:
            try:
                async with asyncio.timeout(timeout):
                    await self._came.wait()
            except TimeoutError:
                quiet = time.monotonic() - (self._subscription.last_publish_at or self._created)
                if quiet > self._silence:
                    text = f"the server sent nothing for {quiet:.1f} s, not even that it is alive"
                    raise ConnectionLostError(text) from None
        if self._ended and not self._waiting:
            raise ConnectionLostError("the server ended the subscription")
        found, self._waiting = self._waiting, []
        if not self._ended:
            self._came.clear()
        return found

    def _take(self, notifications: list[Any]) -> None:
        for each in notifications:
            if isinstance(each, NodeChanges):
                for part in each.parts:
                    self._hold(part)
            elif isinstance(each, ua.DataChangeNotification):
                self._hold(each.MonitoredItems)
            elif isinstance(each, ua.StatusChangeNotification):
                self._ended = True
        self._came.set()

    def _hold(self, part: ValueBlock | list[Any]) -> None:
        """Keep what there is room for, and count the rest."""
        room = max(WAITING, WAITING_OF_EACH * len(self._nodes)) - sum(
            len(each.nodes) for each in self._waiting
        )
        kept = min(len(part), max(room, 0))
        self._count_lost(len(part) - kept)
        if kept:
            self._waiting.append(
                self._reported(part.first(kept) if isinstance(part, ValueBlock) else part[:kept])
            )

    def _reported(self, part: ValueBlock | list[Any]) -> NodeReport:
        names = self._nodes
        if isinstance(part, ValueBlock):
            nodes = [names.get(each, "") for each in part.handles.tolist()]
            if all(nodes):
                return NodeReport(nodes, part)
            part = part.items()
        items = [
            each if isinstance(each, tuple) else (each.ClientHandle, change_of(each.Value))
            for each in part
            if isinstance(each, tuple) or each.Value is not None
        ]
        known = [(names[handle], change) for handle, change in items if handle in names]
        return NodeReport([node for node, _ in known], [change for _, change in known])

    async def _values(self, nodes: list[ua.NodeId]) -> list[ua.DataValue]:
        found: list[ua.DataValue] = await self._session.read_attributes(nodes, ua.AttributeIds.Value)
        return found

    async def _monitor(
        self, nodes: Sequence[str], changed: ua.DataChangeFilter | None
    ) -> dict[str, ua.StatusCode]:
        requests = [self._request(node, changed) for node in nodes]
        answers = await self._creates.ask(self._subscription.create_monitored_items, requests)
        pairs = zip(nodes, answers, strict=True)
        return {node: answer for node, answer in pairs if isinstance(answer, ua.StatusCode)}

    def _request(self, node: str, changed: ua.DataChangeFilter | None) -> ua.MonitoredItemCreateRequest:
        handle = len(self._nodes) + 1
        self._nodes[handle] = node
        return ua.MonitoredItemCreateRequest(
            ItemToMonitor=ua.ReadValueId(
                NodeId=ua.NodeId.from_string(node), AttributeId=ua.AttributeIds.Value
            ),
            MonitoringMode=ua.MonitoringMode.Reporting,
            RequestedParameters=ua.MonitoringParameters(
                ClientHandle=handle,
                SamplingInterval=1000 * self._options.sampling_interval,
                QueueSize=self._options.queue,
                DiscardOldest=True,
                Filter=changed,
            ),
        )

    def _count_lost(self, more: int) -> None:
        if more <= 0:
            return
        if self.lost == 0:
            _LOG.warning("%s: values are discarded, the reader is too slow", self._options.url)
        self.lost += more


async def subscription(client: Client, options: OpcUaOptions) -> NodeSubscription:
    """Create an empty subscription; closing the client's session ends it."""
    wanted = ua.CreateSubscriptionParameters(
        RequestedPublishingInterval=1000 * options.publishing_interval,
        RequestedMaxKeepAliveCount=options.keep_alive,
        RequestedLifetimeCount=max(
            3 * options.keep_alive, math.ceil(_LIFETIME / options.publishing_interval)
        ),
        MaxNotificationsPerPublish=0,
        PublishingEnabled=True,
    )
    publish_fast(client.uaclient.session)
    made = NodeSubscription(client.uaclient.session, wanted, options)
    await made.init()
    return made
