"""Notifications stay in one piece, are bounded by what is watched, and their loss is counted."""

import asyncio
import types

import pytest
from asyncua import ua

from connectors.base import ConnectionLostError
from connectors.opcua import subscription as module
from connectors.opcua.notification import ValueBlock
from connectors.opcua.options import OpcUaOptions
from connectors.opcua.subscription import NodeSubscription
from tests.unit.runtime.agents import virtual

OPTIONS = OpcUaOptions(url="opc.tcp://plant", timeout=1.0)


class Server:
    """A session whose server takes all and sends what the test makes it send."""

    def __init__(self):
        self.handles = {}

    async def create_subscription(self, _wanted, callback):
        self.callback = callback
        return types.SimpleNamespace(
            SubscriptionId=1, RevisedPublishingInterval=500.0, RevisedMaxKeepAliveCount=4
        )

    async def create_monitored_items(self, params):
        for each in params.ItemsToCreate:
            node = each.ItemToMonitor.NodeId.to_string()
            self.handles[node] = each.RequestedParameters.ClientHandle
        return [ua.MonitoredItemCreateResult(MonitoredItemId=k) for k, _ in enumerate(params.ItemsToCreate)]

    @property
    def observer(self):
        return types.SimpleNamespace(on_subscription_event=lambda *_: None)

    async def send(self, *notifications):
        message = ua.NotificationMessage(SequenceNumber=1, NotificationData=[*notifications] or None)
        await self.callback(ua.PublishResult(SubscriptionId=1, NotificationMessage=message))


def changed(*pairs):
    items = [
        ua.MonitoredItemNotification(handle, ua.DataValue(ua.Variant(value, ua.VariantType.Double)))
        for handle, value in pairs
    ]
    return ua.DataChangeNotification(MonitoredItems=items)


async def watching(*nodes):
    server = Server()
    made = NodeSubscription(server, ua.CreateSubscriptionParameters(), OPTIONS)
    await made.init()
    assert await made.add(nodes) == {}
    return server, made


def values(changes):
    return [
        (node, value)
        for nodes, found in changes
        for node, value in zip(
            nodes,
            found.values.tolist() if isinstance(found, ValueBlock) else [each.value for each in found],
            strict=True,
        )
    ]


def test_all_of_a_notification_comes_at_once_and_in_its_order():
    async def scenario():
        server, made = await watching("ns=2;s=A", "ns=2;s=B")
        a, b = server.handles["ns=2;s=A"], server.handles["ns=2;s=B"]
        await server.send(changed((a, 1.0), (b, 2.0)), changed((a, 3.0)))
        return values(await made.changes(1.0)), await made.changes(1.0)

    found, after = virtual(scenario())
    assert found == [("ns=2;s=A", 1.0), ("ns=2;s=B", 2.0), ("ns=2;s=A", 3.0)]
    assert after == []


def test_who_waits_is_woken_by_a_notification():
    async def scenario():
        server, made = await watching("ns=2;s=A")
        waiting = asyncio.create_task(made.changes(1000.0))
        await asyncio.sleep(1.0)
        assert not waiting.done()
        await server.send(changed((server.handles["ns=2;s=A"], 4.0)))
        return values(await asyncio.wait_for(waiting, 1.0))

    assert virtual(scenario()) == [("ns=2;s=A", 4.0)]


def test_a_handle_that_nobody_gave_is_left_out():
    async def scenario():
        server, made = await watching("ns=2;s=A")
        await server.send(changed((77, 1.0), (server.handles["ns=2;s=A"], 2.0)))
        return values(await made.changes(1.0))

    assert virtual(scenario()) == [("ns=2;s=A", 2.0)]


@pytest.mark.parametrize(("nodes", "most"), [(1, 20), (7, 21)])
def test_what_waits_follows_the_number_of_nodes_and_the_rest_is_counted(monkeypatch, nodes, most):
    monkeypatch.setattr(module, "WAITING", 20)
    monkeypatch.setattr(module, "WAITING_OF_EACH", 3)

    async def scenario():
        server, made = await watching(*[f"ns=2;s={k}" for k in range(nodes)])
        for _ in range(5):
            await server.send(changed(*[(server.handles["ns=2;s=0"], float(k)) for k in range(10)]))
        found = len(values(await made.changes(1.0)))
        lost = made.lost
        await server.send(changed((server.handles["ns=2;s=0"], 1.0)))
        return found, lost, len(values(await made.changes(1.0))), made.lost

    assert virtual(scenario()) == (most, 50 - most, 1, 50 - most)


def test_its_end_is_a_loss_after_what_came_before():
    async def scenario():
        server, made = await watching("ns=2;s=A")
        await server.send(changed((server.handles["ns=2;s=A"], 1.0)), ua.StatusChangeNotification())
        assert values(await made.changes(1.0)) == [("ns=2;s=A", 1.0)]
        for _ in range(2):
            with pytest.raises(ConnectionLostError, match="ended the subscription"):
                await made.changes(1.0)

    virtual(scenario())


def test_silence_without_a_sign_of_life_is_a_loss():
    async def scenario(monkeypatch):
        _, made = await watching("ns=2;s=A")
        monkeypatch.setattr(module.time, "monotonic", lambda: made._created + 2.9)
        assert await made.changes(0.5) == []
        monkeypatch.setattr(module.time, "monotonic", lambda: made._created + 3.1)
        with pytest.raises(ConnectionLostError, match=r"sent nothing for 3\.1 s"):
            await made.changes(0.5)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(module, "time", types.SimpleNamespace(monotonic=module.time.monotonic))
        virtual(scenario(patch))
