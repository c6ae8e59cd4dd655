"""Our own OPC UA server and its clients: what they see, what they may ask, and what they cannot do to it."""

import asyncio
import contextlib
import socket
import struct
import time

import pytest
import pytest_asyncio
from asyncua import Client, ua
from asyncua.crypto.security_policies import SecurityPolicyBasic256Sha256
from buses import free_port, listens, until
from opcua_clients import alarm_list, alarms_at, session_around_the_endpoints
from secure_peers import PASSWORD, make_keys

from agent.runtime.agent import Agent
from agent.runtime.loop.workers import InlineExecutor
from agent.settings import AgentSettings, ConnectionSettings, Settings
from connectors.base import ConnectionLostError, Order
from connectors.opcua_server.asyncua_private import client_sessions, monitored_items
from connectors.opcua_server.connector import OpcUaServerConnector
from connectors.opcua_server.listening import look_after
from connectors.opcua_server.options import OpcUaServerOptions, OpcUaServerTarget
from connectors.options import LoopTags, Options
from tests.unit.connectors.alarm_messages import told
from tests.unit.runtime.fake_bus import FakeBus
from tests.unit.runtime.loops import loop_settings, sample
from tests.unit.runtime.test_agent import judged

pytestmark = [
    pytest.mark.asyncio(loop_scope="module"),
    pytest.mark.timeout(180),  # a start loads thousands of nodes: ten times longer where others compute
]
LOOPS = tuple(f"FIC10{n}" for n in range(1, 7))


def connector_at(port, loops=LOOPS, **options):
    target = OpcUaServerTarget(connection="ours", unit="%")
    chosen = OpcUaServerOptions.model_validate({"port": port, **options})
    return OpcUaServerConnector("ours", chosen, dict.fromkeys(loops, LoopTags({}, [target])))


class Served:
    """A server at work and where it listens."""

    def __init__(self, session, port):
        self.publish = session.publish
        self.session = session
        self.port = port
        self._orders = session.samples()

    async def order(self):
        async with asyncio.timeout(30):
            return await anext(self._orders)

    async def become(self, loop, state, **fields):
        """Tell a change as the agent does: the state, then the event."""
        at = time.time()
        await self.publish(told(loop, state, at=at, **fields))
        await self.publish(told(loop, state, "event", at=at, **fields))


@contextlib.asynccontextmanager
async def serving(**options):
    port, before = free_port(), asyncio.all_tasks()
    async with connector_at(port, **options).session() as session:
        served = Served(session, port)
        yield served
        await served._orders.aclose()
    assert not listens(port)
    await asyncio.sleep(0)
    assert asyncio.all_tasks() - before - {asyncio.current_task()} == set(), "the server left tasks running"


@pytest_asyncio.fixture(scope="module", loop_scope="module")
async def served():
    """A server on this machine where everybody may give orders; each test has a loop of its own."""
    async with serving(anonymous="order") as made:
        yield made


@pytest.fixture(scope="module")
def keys(tmp_path_factory):
    folder = make_keys(tmp_path_factory.mktemp("keys"))
    (folder / "password").write_text(PASSWORD)
    return folder


@pytest_asyncio.fixture(scope="module", loop_scope="module")
async def guarded(keys):
    """A server that knows one client and two users."""
    security = {"certificate": f"{keys}/opcua.pem", "key": f"{keys}/opcua-key.pem"}
    password = {"file": f"{keys}/password"}
    async with serving(
        security={**security, "clients": [f"{keys}/opcua.der"], "ca": f"{keys}/ca.pem", "sign_only": True},
        users={"jane": {"password": password}, "wall": {"password": password, "may": "read"}},
        anonymous="refused",
    ) as made:
        yield made


@contextlib.asynccontextmanager
async def client_of(
    guarded, keys, user="jane", password=PASSWORD, certificate="opcua", *, mode="SignAndEncrypt"
):
    client = Client(f"opc.tcp://127.0.0.1:{guarded.port}", timeout=30)
    client.application_uri = "urn:agent:slipjump"
    client.set_user(user)
    client.set_password(password)
    await client.set_security(
        SecurityPolicyBasic256Sha256,
        f"{keys}/{certificate}.pem",
        f"{keys}/{certificate}-key.pem",
        mode=ua.MessageSecurityMode[mode],
    )
    async with client:
        yield client


async def test_an_alarm_is_seen_acknowledged_and_seen_to_be(served):
    async with alarms_at(served.port) as alarms:
        await served.become("FIC101", "unacked_active")
        event = await alarms.newest("FIC101", 1)
        assert event.NodeId == ua.NodeId("FIC101.Alarm", alarms.index)  # the ConditionId
        assert (event.ConditionName, event.Severity, event.Retain) == ("Stiction", 700, True)
        assert getattr(event, "ActiveState/Id")
        assert not getattr(event, "AckedState/Id")
        assert event.Message.Text == "FIC101: valve sticks: S 4, J 1"

        assert await alarms.acknowledge(event, "looked at") == "Good"
        order = await served.order()
        assert order == Order("FIC101", "acknowledge", order.by, alarm="FIC101/1")
        assert order.by.endswith("(127.0.0.1)")
        await served.become("FIC101", "acked_active", by=order.by)
        acked = await alarms.newest("FIC101", 2)
        assert getattr(acked, "AckedState/Id")
        assert acked.Comment.Text == "looked at"
        assert acked.ClientUserId == order.by

        assert await alarms.acknowledge(event) == "BadEventIdUnknown"
        assert await alarms.acknowledge(acked) == "BadConditionBranchAlreadyAcked"
        await served.become("FIC101", "normal")
        assert not (await alarms.newest("FIC101", 3)).Retain
        await served.become("FIC101", "unacked_active", id="FIC101/2")
        again = await alarms.newest("FIC101", 4)
        assert await alarms.acknowledge(event) == "BadEventIdUnknown"
        assert await alarms.acknowledge(again) == "Good"
        assert (await served.order()).alarm == "FIC101/2"
        assert len(alarms.of("FIC101")) == 4  # no message made an event of its own that told nothing new


async def test_a_refresh_tells_what_is_retained_to_who_asks(served):
    await served.become("FIC102", "unacked_active")
    await served.become("FIC103", "unacked_active")
    await served.become("FIC103", "normal")
    async with alarms_at(served.port) as alarms, alarms_at(served.port, "FIC103") as of_one_loop:
        await of_one_loop.refresh()
        assert of_one_loop.marks == ["start", "end"]
        await alarms.refresh()
        marks = [mark for mark in alarms.marks if mark in {"start", "end", "FIC102", "FIC103"}]
        assert marks == ["start", "FIC102", "end"]
        (event,) = alarms.of("FIC102")
        first = await alarms.node("FIC102.Alarm.EventId").read_value()
        assert event.EventId == first
        with pytest.raises(ua.UaStatusCodeError, match="BadSubscriptionIdInvalid"):
            await alarms.refresh(of_one_loop.subscription.subscription_id)
        await served.become("FIC103", "unacked_active", id="FIC103/2")
        await of_one_loop.newest("FIC103", 1)
        await alarms.newest("FIC103", 1)
        await served.become("FIC103", "normal")


async def test_values_have_status_time_and_unit(served):
    async with alarms_at(served.port) as alarms:

        async def read(name):
            return await alarms.node(f"FIC104.{name}").read_data_value(raise_on_bad_status=False)

        assert (await read("S")).StatusCode.name == "BadWaitingForInitialData"
        await served.publish(told("FIC104", "unacked_active", at=1.7e9))
        shown = await read("S")
        assert (shown.Value.Value, shown.StatusCode.name) == (4.0, "Good")
        assert shown.SourceTimestamp.timestamp() == 1.7e9
        assert [(await read(name)).Value.Value for name in ("Active", "State", "NE107", "DeviceHealth")] == [
            True,
            "unacked_active",
            "maintenance_required",
            4,
        ]
        await served.publish(told("FIC104", "unacked_active", verdict="undecided"))
        assert (await read("S")).StatusCode.name == "UncertainLastUsableValue"
        await served.publish(told("FIC104", "normal", verdict="no_stiction", s=None))
        assert (await read("S")).StatusCode.name == "BadNoData"
        assert (await alarms.node("FIC104.S.EngineeringUnits").read_value()).DisplayName.Text == "%"
        words = await alarms.node("FIC104.DeviceHealth.EnumStrings").read_value()
        assert words[4].Text == "MAINTENANCE_REQUIRED"


async def test_shelving_and_taking_out_of_service(served):
    loop, state = "FIC105", {"part": ".ShelvingState"}
    await served.become(loop, "unacked_active")
    async with alarms_at(served.port) as alarms:
        shelve, unshelve = "ShelvedStateMachineType_TimedShelve", "ShelvedStateMachineType_Unshelve"
        for wrong in (0.0, -1.0, float("nan"), 1000 * 604_801.0):
            assert await alarms.call(loop, shelve, wrong, **state) == "BadShelvingTimeOutOfRange"
        assert await alarms.call(loop, shelve, "a while") == "BadInvalidArgument"
        assert await alarms.call(loop, shelve) == "BadArgumentsMissing"
        assert await alarms.call(loop, unshelve) == "BadConditionNotShelved"
        assert await alarms.call(loop, shelve, 3_600_000.0, **state) == "Good"
        order = await served.order()
        assert (order.action, order.subject) == ("shelve", loop)
        assert abs(order.until - time.time() - 3600) < 60
        await served.become(loop, "shelved", by=order.by, until=order.until)
        event = await alarms.newest(loop, 1)
        assert event.SuppressedOrShelved
        assert getattr(event, "ShelvingState/CurrentState/Id").Identifier == 2932
        assert 0 < getattr(event, "ShelvingState/UnshelveTime") <= 3_600_000
        assert await alarms.call(loop, shelve, 1000.0) == "BadConditionAlreadyShelved"
        assert await alarms.call(loop, unshelve, **state) == "Good"
        assert (await served.order()).action == "unshelve"
        await served.become(loop, "normal")

        out, back = "AlarmConditionType_RemoveFromService2", "AlarmConditionType_PlaceInService"
        assert await alarms.call(loop, back) == "BadInvalidState"
        assert await alarms.call(loop, out, ua.LocalizedText("valve is out")) == "Good"
        assert (await served.order()).action == "out_of_service"
        await served.become(loop, "out_of_service", by="jane")
        event = await alarms.newest(loop, 3)
        assert getattr(event, "OutOfServiceState/Id")
        assert event.Comment.Text == "valve is out"
        assert await alarms.call(loop, back) == "Good"
        assert (await served.order()).action == "in_service"
        assert await alarms.call(loop, "ShelvedStateMachineType_OneShotShelve") == "BadNotSupported"
        assert await alarms.call("FIC999", shelve, 1000.0) == "BadNodeIdInvalid"


async def test_users_do_what_they_may(guarded, keys):
    await guarded.become("FIC101", "unacked_active")
    async with client_of(guarded, keys) as client, alarm_list(client) as alarms:
        await alarms.refresh()
        assert await alarms.acknowledge(alarms.of("FIC101")[0]) == "Good"
        assert (await guarded.order()).by == "jane"
        with pytest.raises(ua.UaStatusCodeError, match="BadUserAccessDenied"):
            await alarms.node("FIC101.S").write_value(9.0)
    async with client_of(guarded, keys, "wall", mode="Sign") as client, alarm_list(client) as alarms:
        await alarms.refresh()
        assert await alarms.acknowledge(alarms.of("FIC101")[0]) == "BadUserAccessDenied"


async def test_strangers_stay_outside(guarded, keys, caplog):
    for user, password in (("jane", "wrong"), ("jim", PASSWORD), ("jane", "")):
        with pytest.raises(ua.UaStatusCodeError, match="BadUserAccessDenied"):
            async with client_of(guarded, keys, user, password):
                pass
    with pytest.raises(ua.UaStatusCodeError, match="BadCertificateUntrusted"):
        async with client_of(guarded, keys, certificate="stranger"):
            pass
    with pytest.raises(ua.UaStatusCodeError, match="BadCertificateUntrusted"):
        await session_around_the_endpoints(guarded.port, PASSWORD)
    assert "user 'jim' was not let in" in caplog.text
    assert PASSWORD not in caplog.text


async def test_nobody_can_write_any_node(served):
    space = served.session._server.iserver.aspace
    levels = (ua.AttributeIds.AccessLevel, ua.AttributeIds.UserAccessLevel)
    bit = 1 << ua.AccessLevel.CurrentWrite

    def writable(node, level):
        value = space.read_attribute_value(node, level).Value
        return value is not None and bool((value.Value or 0) & bit)

    nodes = list(space.keys())
    assert not [node for node in nodes if all(writable(node, level) for level in levels)]
    assert len(nodes) > 5000


async def test_what_a_client_may_ask_for_is_bounded(served, monkeypatch):
    internal = served.session._server.iserver
    async with alarms_at(served.port) as alarms:
        eager = await alarms.client.create_subscription(0.001)
        kept = internal.subscription_service.subscriptions[eager.subscription_id]
        assert kept.data.RevisedPublishingInterval == 50.0
        await eager.subscribe_data_change(alarms.node("FIC101.S"), queuesize=0)
        assert [item.queue_size for item in monitored_items(kept).values()] == [1000]
        monkeypatch.setattr("connectors.opcua_server.caller.MOST_ITEMS", 1)
        with pytest.raises(ua.UaStatusCodeError, match="BadTooManyMonitoredItems"):
            await eager.subscribe_data_change(alarms.node("FIC101.J"))
        with pytest.raises(ua.UaStatusCodeError, match="BadServiceUnsupported"):
            await alarms.client.uaclient.register_server(ua.RegisteredServer())
        assert {session.session_timeout for session in client_sessions(internal)} == {60.0}
        tokens = {session.auth_token.Identifier for session in client_sessions(internal)}
        assert all(isinstance(token, bytes) and len(token) == 32 for token in tokens)


async def test_a_client_that_sends_without_end_is_dropped(served):
    reader, writer = await asyncio.open_connection("127.0.0.1", served.port)
    writer.write(b"HELF" + struct.pack("<I", 2**31) + bytes(2**20))
    with contextlib.suppress(ConnectionError):
        assert await reader.read() == b""
    writer.close()
    async with alarms_at(served.port) as alarms:  # the others are served
        assert await alarms.node("/Agent.Loops").read_value() == len(LOOPS)


async def test_a_client_that_does_not_read_is_dropped(served):
    server, schema = served.session._server, ua.NodeId(ua.ObjectIds.OpcUa_XmlSchema)
    assert len(server.iserver.aspace.read_attribute_value(schema, ua.AttributeIds.Value).Value.Value) > 2**17
    client = Client(f"opc.tcp://127.0.0.1:{served.port}", timeout=30)
    await client.connect()
    client.uaclient.protocol.transport.pause_reading()
    reads = [asyncio.create_task(client.get_node(schema).read_value()) for _ in range(200)]
    await until(
        lambda: any(c.transport.get_write_buffer_size() > 8 * 2**20 for c in server.bserver.clients), 30.0
    )
    look_after(server)
    client.uaclient.protocol.transport.resume_reading()
    results = await asyncio.gather(*reads, return_exceptions=True)
    assert any(isinstance(result, Exception) for result in results)
    with contextlib.suppress(ConnectionError, ua.UaError):
        await client.disconnect()


async def test_a_taken_port_is_told_and_the_next_session_shows_what_the_last_one_did():
    port = free_port()
    connector = connector_at(port, ["FIC101"])
    with socket.socket() as other:
        other.bind(("127.0.0.1", port))
        other.listen()
        with pytest.raises(ConnectionLostError, match=rf"cannot listen on 127.0.0.1:{port}: Address already"):
            async with connector.session():
                pass
    async with connector.session() as session:
        await session.publish(told("FIC101", "unacked_active"))
        client = Client(f"opc.tcp://127.0.0.1:{port}", timeout=30)
        await client.connect()
    with contextlib.suppress(ConnectionError, ua.UaError):
        await client.disconnect()  # it was there when the server ended
    async with connector.session(), alarms_at(port) as alarms:
        await alarms.refresh()
        assert getattr(alarms.of("FIC101")[0], "ActiveState/Id")
    assert not listens(port)


async def test_from_the_plant_to_the_operator_and_back(tmp_path):
    """The agent's alarm is acknowledged over OPC UA; a new agent shows it as it was."""
    port = free_port()

    def swing(_):
        for k in range(200):
            yield sample("pv", float(k), 50.0 + k % 7)
            yield sample("op", float(k), 50.0 - k % 5)

    def agent(plant):
        target = OpcUaServerTarget(connection="ours")
        settings = Settings(
            AgentSettings(state=tmp_path / "state.sqlite", clock_error=None),
            {
                "plant": ConnectionSettings("fake", Options()),
                "ours": ConnectionSettings("opcua_server", Options()),
            },
            (loop_settings(connection="plant", seconds=100.0, quantify="always", publish=(target,)),),
        )
        buses = [FakeBus(plant, "plant"), connector_at(port, ["FIC101"], anonymous="order")]
        return Agent(settings, InlineExecutor(), connectors=buses, diagnose=judged())

    async def state(alarms, wanted):
        node = alarms.node("FIC101.State")
        async with asyncio.timeout(30):
            while (await node.read_data_value(raise_on_bad_status=False)).Value.Value != wanted:  # noqa: ASYNC110
                await asyncio.sleep(0.01)

    first = asyncio.create_task(agent(swing).run())
    await until(lambda: listens(port), within=60)
    async with alarms_at(port) as alarms:
        await alarms.refresh()
        await state(alarms, "unacked_active")
        assert await alarms.acknowledge(await alarms.newest("FIC101", 1)) == "Good"
        await state(alarms, "acked_active")
        assert getattr(await alarms.newest("FIC101", 2), "AckedState/Id")
    first.cancel()
    await asyncio.wait({first})

    second = asyncio.create_task(agent(lambda _: []).run())
    await until(lambda: listens(port), within=60)
    async with alarms_at(port) as alarms:
        await state(alarms, "acked_active")
    second.cancel()
    await asyncio.wait({second})
