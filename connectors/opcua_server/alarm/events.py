"""Events to those who subscribed, and ConditionRefresh.

asyncua 2.1 sends an event to subscribers of one node only, and its own refresh answers anybody for any
subscription, only on the Server object, and marks start and end so that the client's filter drops them.
"""

from __future__ import annotations

import uuid
from collections.abc import Iterable, Mapping, Sequence
from datetime import UTC, datetime
from typing import Any

from asyncua import Server, ua
from asyncua.common.events import Event
from asyncua.server.internal_subscription import InternalSubscription

from connectors.opcua_server.alarm.method import status, values_of
from connectors.opcua_server.asyncua_private import event_items, monitored_items, send_event
from connectors.opcua_server.caller import CALLER

Fields = Mapping[str, ua.Variant]
SERVER = ua.NodeId(ua.ObjectIds.Server)
CONDITION_ID = "NodeId"
"""How asyncua calls what a client selects by the attribute NodeId of ConditionType (Part 9, 5.5.2.13)."""


class Events:
    """Knows what is retained and sends events."""

    def __init__(self, server: Server, area: ua.NodeId) -> None:
        """Make it.

        Args:
            server: Whose clients get events.
            area: Object above all loops; whoever subscribes to it or to the Server object gets all events.
        """
        self._server = server
        self._everywhere = (SERVER, area)
        self._retained: dict[ua.NodeId, tuple[ua.NodeId, Fields]] = {}
        for method in (
            ua.ObjectIds.ConditionType_ConditionRefresh,
            ua.ObjectIds.ConditionType_ConditionRefresh2,
        ):
            server.iserver.isession.add_method_callback(ua.NodeId(method), self._refresh)

    def retain(self, condition: ua.NodeId, source: ua.NodeId, fields: Fields) -> None:
        """Remember where a condition stands, for clients that come later; forget it where it need not be."""
        if fields["Retain"].Value:
            self._retained[condition] = (source, fields)
        else:
            self._retained.pop(condition, None)

    async def tell(self, condition: ua.NodeId, source: ua.NodeId, fields: Fields) -> None:
        """Send the event of a condition to all who subscribed to its source or above."""
        event = _event(fields, condition)
        for subscription in list(self._server.iserver.subscription_service.subscriptions.values()):
            for item in _items(subscription, (*self._everywhere, source)):
                await send_event(subscription, event, item)

    async def _refresh(self, _: ua.NodeId, *arguments: ua.Variant) -> ua.CallMethodResult:
        """ConditionRefresh(SubscriptionId) and ConditionRefresh2(SubscriptionId, MonitoredItemId)."""
        kinds = (ua.VariantType.UInt32,) * (2 if len(arguments) > 1 else 1)
        values, refusal = values_of(arguments, kinds)
        if refusal is not None:
            return refusal
        subscription = self._server.iserver.subscription_service.subscriptions.get(values[0])
        if subscription is None or subscription.session_id != CALLER.get().session_id:
            return status(ua.StatusCodes.BadSubscriptionIdInvalid)
        items = {item: node for node, items in event_items(subscription).items() for item in items}
        if len(values) > 1:
            if values[1] not in items:
                return status(ua.StatusCodes.BadMonitoredItemIdInvalid)
            items = {values[1]: items[values[1]]}
        await self._mark(subscription, items, ua.ObjectIds.RefreshStartEventType)
        for condition, (source, fields) in list(self._retained.items()):
            event = _event(fields, condition)
            for item, node in items.items():
                if node in (*self._everywhere, source):
                    await send_event(subscription, event, item)
        await self._mark(subscription, items, ua.ObjectIds.RefreshEndEventType)
        return status(ua.StatusCodes.Good)

    async def _mark(self, subscription: InternalSubscription, items: Iterable[int], kind: int) -> None:
        """Send start or end of a refresh, whatever the filter says (Part 9, 5.5.7)."""
        event, now = Event(), datetime.now(UTC)
        for name, value, variant_type in (
            ("EventId", uuid.uuid4().bytes, ua.VariantType.ByteString),
            ("EventType", ua.NodeId(kind), ua.VariantType.NodeId),
            ("SourceNode", SERVER, ua.VariantType.NodeId),
            ("SourceName", "Server", ua.VariantType.String),
            ("Time", now, ua.VariantType.DateTime),
            ("ReceiveTime", now, ua.VariantType.DateTime),
            ("Message", ua.LocalizedText(ua.ObjectIdNames[kind]), ua.VariantType.LocalizedText),
            ("Severity", 1, ua.VariantType.UInt16),
        ):
            event.add_property(name, value, variant_type)
        for item in items:
            data = monitored_items(subscription)[item]
            marked = ua.EventFieldList(data.client_handle, event.to_event_fields(data.filter.SelectClauses))
            await subscription.enqueue_event(item, marked, data.queue_size)


def _event(fields: Fields, condition: ua.NodeId) -> Any:  # noqa: ANN401 - asyncua's own
    event = Event()
    for name, value in fields.items():
        event.add_property(name, value.Value, value.VariantType)
    event.add_property(CONDITION_ID, condition, ua.VariantType.NodeId)
    return event


def _items(subscription: InternalSubscription, nodes: Sequence[ua.NodeId]) -> list[int]:
    monitored = event_items(subscription)
    return [item for node in nodes for item in monitored.get(node, ())]
