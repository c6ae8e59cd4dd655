"""A subscription that says so when it dies.

asyncua's own guard recreates a silent subscription by itself and can lose its nodes while doing so. Therefore
the subscription is made without the client's knowledge, and whoever reads it gets an error when it is dead.
"""

from __future__ import annotations

import logging
import math
import time
from collections.abc import Sequence

from asyncua import Client, ua
from asyncua.common.subscription import DataChangeEvent, OverflowPolicy, Subscription

from connectors.base import ConnectionLostError
from connectors.opcua.batches import Batches
from connectors.opcua.options import OpcUaOptions

_LOG = logging.getLogger(__name__)
_WAITING = 10_000
"""Most values that may wait to be read."""
_LIFETIME = 60.0
"""How long the server keeps a subscription that nobody reads, s."""
_NO_FILTER = (
    ua.StatusCodes.BadFilterNotAllowed,
    ua.StatusCodes.BadMonitoredItemFilterInvalid,
    ua.StatusCodes.BadMonitoredItemFilterUnsupported,
)


class NodeSubscription:
    """Changes of many nodes; made by ``subscription``."""

    def __init__(self, subscription: Subscription, options: OpcUaOptions, silence: float) -> None:
        self._subscription = subscription
        self._session = subscription.server
        self._options = options
        self._silence = silence
        self._created = time.monotonic()
        self._handle = 0
        self._dropped = 0
        self._reads, self._creates = Batches(), Batches()
        subscription.set_overflow_disconnect_handler(self._count_dropped)

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

    async def next_change(self, timeout: float) -> DataChangeEvent | None:  # noqa: ASYNC109 - not to be cancelled
        """Return the next change, None if there was none for ``timeout`` s; raises ConnectionLostError."""
        event = await self._subscription.next_event(timeout)
        if isinstance(event, DataChangeEvent):
            return event
        if event is not None:
            raise ConnectionLostError("the server ended the subscription")
        quiet = time.monotonic() - (self._subscription.last_publish_at or self._created)
        if quiet > self._silence:
            raise ConnectionLostError(f"the server sent nothing for {quiet:.1f} s, not even that it is alive")
        return None

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
        self._handle += 1
        return ua.MonitoredItemCreateRequest(
            ItemToMonitor=ua.ReadValueId(
                NodeId=ua.NodeId.from_string(node), AttributeId=ua.AttributeIds.Value
            ),
            MonitoringMode=ua.MonitoringMode.Reporting,
            RequestedParameters=ua.MonitoringParameters(
                ClientHandle=self._handle,
                SamplingInterval=1000 * self._options.sampling_interval,
                QueueSize=self._options.queue,
                DiscardOldest=True,
                Filter=changed,
            ),
        )

    def _count_dropped(self) -> None:
        if self._dropped == 0:
            _LOG.warning("%s: values are dropped, the reader is too slow", self._options.url)
        self._dropped += 1


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
    # the policy named disconnect calls our handler for every dropped value, the others drop unseen
    made = Subscription(
        client.uaclient.session, wanted, queue_maxsize=_WAITING, overflow=OverflowPolicy.DISCONNECT
    )
    granted = await made.init()
    alive = granted.RevisedPublishingInterval / 1000 * granted.RevisedMaxKeepAliveCount
    return NodeSubscription(made, options, alive + options.timeout)
