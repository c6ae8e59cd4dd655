"""Our own OPC UA server and its clients: what they see, what they may ask, and what they cannot do to it."""

import asyncio
import contextlib
import socket
import time

import pytest
import pytest_asyncio
from asyncua import Client, ua
from buses import listens, until
from opcua_clients import alarms_at

from agent.runtime.agent import Agent
from agent.runtime.loop.workers import InlineExecutor
from agent.settings import AgentSettings, ConnectionSettings, Settings
from connectors.base import ConnectionLostError, Order
from connectors.opcua_server.options import OpcUaServerTarget
from connectors.options import Options
from tests.integration.opcua_served import connector_at, serving
from tests.ports import free_port
from tests.unit.connectors.alarm_messages import told
from tests.unit.runtime.agents import judged
from tests.unit.runtime.fake_bus import FakeBus
from tests.unit.runtime.loops import loop_settings, sample

pytestmark = [
    pytest.mark.asyncio(loop_scope="module"),
    pytest.mark.timeout(180),  # a start loads thousands of nodes: ten times longer where others compute
]


@pytest_asyncio.fixture(scope="module", loop_scope="module")
async def served():
    """A server on this machine where everybody may give orders; each test has a loop of its own."""
    async with serving(anonymous="order") as made:
        yield made


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
        # Before the agent has obeyed: the second is too late, and the comment of the first stays.
        assert await alarms.acknowledge(event, "me too") == "BadConditionBranchAlreadyAcked"
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


async def test_a_refresh_reports_what_is_retained_to_who_requests(served):
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


async def test_a_taken_port_is_reported_and_the_next_session_shows_what_the_last_one_did():
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
        # an alarm that begins during the refresh is sent by both, so the second event need not be the last
        await until(lambda: getattr(alarms.of("FIC101")[-1], "AckedState/Id"), within=30.0)
    first.cancel()
    await asyncio.wait({first})

    second = asyncio.create_task(agent(lambda _: []).run())
    await until(lambda: listens(port), within=60)
    async with alarms_at(port) as alarms:
        await state(alarms, "acked_active")
    second.cancel()
    await asyncio.wait({second})
