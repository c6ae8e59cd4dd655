"""A Sparkplug host on a real broker sees the node being born, telling data, obeying and dying."""

import asyncio
import contextlib
import socket

import pytest
from aiomqtt import Client
from buses import connector_of, mosquitto_broker

from agent.alarms import Alarm, Announcement, Command
from connectors.base import ConnectionLostError, Order, Publication
from connectors.checks import Reader
from connectors.checks.proxy import BLACK_HOLE, REFUSE, STALL, FaultProxy
from connectors.checks.session import until
from connectors.sparkplug.metrics import METRICS, REBIRTH
from connectors.sparkplug.payload import DataType, Metric, decode, encode
from tests.unit.runtime.agents import agent_of
from tests.unit.runtime.fake_bus import FakeBus

NODE = "spBv1.0/plant/{}/gate"
NOW = 1.8e9


def connector(port, *loops, **options):
    entries = [
        {"name": loop, "tags": {}, "publish": [{"connection": "plant"}]} for loop in loops or ("FIC101",)
    ]
    connection = {"kind": "sparkplug", "port": port, "group": "plant", "node": "gate", **options}
    return connector_of(connection, entries)


def publication(kind="state", **changes):
    fields = Announcement("state", Alarm("FIC101"), 5.0).fields() | {"sequence": 7, "historical": False}
    return Publication("FIC101", kind, "1", fields | changes)


@contextlib.asynccontextmanager
async def host(port):
    """Yield a client, and all that nodes say: (verb, device, payload)."""
    heard = []

    async def listen():
        async for message in client.messages:
            _, _, verb, _, *device = message.topic.value.split("/")
            assert not message.retain
            heard.append((verb, device[0] if device else None, decode(message.payload)))

    async with Client("127.0.0.1", port) as client:
        await client.subscribe(
            [(f"spBv1.0/plant/{verb}/#", 1) for verb in ["NBIRTH", "NDEATH", "DBIRTH", "DDATA"]]
        )
        task = asyncio.create_task(listen())
        try:
            yield client, heard
        finally:
            task.cancel()
            await asyncio.wait({task})


def verbs(heard):
    return [verb for verb, _, _ in heard]


def bd_seq(payload):
    return next(metric.value for metric in payload.metrics if metric.name == "bdSeq")


def told(heard):
    """What was told of the loop: the metrics of each message by name."""
    return [
        {metric.name: metric for metric in payload.metrics}
        for verb, device, payload in heard
        if device == "FIC101" and verb in {"DBIRTH", "DDATA"}
    ]


def history(heard):
    """What was told late: id of the message -> state. The same may come twice, as on any bus."""
    late = (each for each in told(heard) if each["Message/Id"].historical)
    return {each["Message/Id"].value: each["Alarm/State"].value for each in late}


def now(heard):
    """The newest state."""
    fresh = [each["Alarm/State"] for each in told(heard) if "Alarm/State" in each]
    return [metric.value for metric in fresh if not metric.historical][-1]


async def command(client, verb, device=None, **values):
    metrics = [Metric(name, value, kind, NOW) for name, (value, kind) in values.items()]
    topic = NODE.format(verb) + (f"/{device}" if device else "")
    await client.publish(topic, encode(metrics, NOW))


@pytest.mark.parametrize("version", ["3.1.1", "5"])
async def test_birth_data_rebirth_and_both_kinds_of_death(mosquitto, tmp_path, version):
    async with mosquitto_broker(mosquitto, tmp_path) as (port, _), host(port) as (client, heard):
        bus = connector(port, "FIC101", "FIC102", version=version)
        async with bus.session() as session, Reader(session):
            await session.publish(publication(state="unacked_active", s=4.0))
            await until(lambda: len(heard) == 4)
            await command(client, "NCMD", **{REBIRTH: (True, DataType.BOOLEAN)})
            await until(lambda: len(heard) == 7)
            await session.publish(publication(state="acked_active", s=4.0))
        await until(lambda: len(heard) == 9)
        with contextlib.suppress(Exception):
            async with bus.session() as session:
                await until(lambda: len(heard) == 12)
                session._client._client.socket().shutdown(socket.SHUT_RDWR)
                await until(lambda: len(heard) == 13)
    births = ["NBIRTH", "DBIRTH", "DBIRTH"]
    assert verbs(heard) == [*births, "DDATA", *births, "DDATA", "NDEATH", *births, "NDEATH"]
    assert [payload.seq for _, _, payload in heard] == [0, 1, 2, 3, 0, 1, 2, 3, None, 0, 1, 2, None]
    assert [device for _, device, _ in heard[:4]] == [None, "FIC101", "FIC102", "FIC101"]
    numbered = [bd_seq(payload) for verb, _, payload in heard if verb in {"NBIRTH", "NDEATH"}]
    assert numbered == [0, 0, 0, 1, 1]
    reborn = {metric.name: metric.value for metric in heard[5][2].metrics}
    assert (reborn["Alarm/State"], reborn["Stiction/S"], reborn["Stiction/J"]) == (
        "unacked_active",
        4.0,
        None,
    )
    assert {metric.name: metric.value for metric in heard[7][2].metrics} == {"Alarm/State": "acked_active"}
    assert [metric.name for metric in heard[1][2].metrics] == list(METRICS)


async def test_a_command_is_an_order_and_a_retained_or_broken_one_is_not(mosquitto, tmp_path, caplog):
    yes = (True, DataType.BOOLEAN)
    async with mosquitto_broker(mosquitto, tmp_path) as (port, _), host(port) as (client, heard):
        kept = encode([Metric("Alarm/Unshelve", *yes)], NOW)
        await client.publish(NODE.format("DCMD") + "/FIC101", kept, retain=True)
        bus = connector(port, orders=True)
        async with bus.session() as session, Reader(session) as reading:
            await until(lambda: bus.retained == 1)
            for raw in (b"\xff\xff", encode([Metric("Alarm/Active", *yes)], NOW)):
                await client.publish(NODE.format("DCMD") + "/FIC101", raw)
            await command(client, "DCMD", "FIC999", **{"Alarm/Acknowledge": yes})
            operator = ("jane", DataType.STRING)
            await command(client, "DCMD", "FIC101", **{"Alarm/Acknowledge": yes, "Alarm/Operator": operator})
            await until(lambda: reading.orders)
    assert reading.orders == [Order("FIC101", "acknowledge", "jane")]
    assert (bus.malformed, bus.retained) == (2, 1)
    assert "a command cannot be obeyed: no Sparkplug payload" in caplog.text
    assert verbs(heard) == ["NBIRTH", "DBIRTH", "NDEATH"]


async def test_without_orders_a_host_can_only_request_births(mosquitto, tmp_path):
    async with mosquitto_broker(mosquitto, tmp_path) as (port, _), host(port) as (client, heard):
        async with connector(port).session() as session, Reader(session) as reading:
            await command(client, "DCMD", "FIC101", **{"Alarm/Acknowledge": (True, DataType.BOOLEAN)})
            await command(client, "NCMD", **{REBIRTH: (True, DataType.BOOLEAN)})
            await until(lambda: verbs(heard).count("NBIRTH") == 2)
        assert reading.orders == []


async def test_a_killed_broker_is_reported(mosquitto, tmp_path):
    async with (
        mosquitto_broker(mosquitto, tmp_path) as (port, process),
        connector(port).session() as session,
        Reader(session) as reading,
    ):
        process.kill()
        with pytest.raises(ConnectionLostError):
            await reading.end(within=30.0)
        with pytest.raises(ConnectionLostError):
            await session.publish(publication())


@pytest.mark.parametrize("fault", [REFUSE, BLACK_HOLE, STALL], ids=lambda fault: fault.name)
async def test_no_event_is_lost_that_comes_while_the_broker_is_away(fault, mosquitto, tmp_path):
    """The whole agent: a host hears of the death, then how it is, and as history what it missed."""
    async with (
        mosquitto_broker(mosquitto, tmp_path) as (port, _),
        host(port) as (_, heard),
        FaultProxy(port) as proxy,
    ):
        agent = agent_of(FakeBus(lambda _: ()), scada=connector(proxy.port, keepalive=1, timeout=1.0))
        pipeline, scada = agent._pipelines["FIC101"], agent._wiring.connections["plant"]
        work = asyncio.create_task(agent.run())
        try:
            await until(lambda: verbs(heard)[:2] == ["NBIRTH", "DBIRTH"], 30)
            async with proxy.suffering(fault):
                await until(lambda: not scada.health.up, 30)
                for second, action in enumerate(("out_of_service", "in_service", "out_of_service")):
                    pipeline.obey(Command.of_action(action, "jane", NOW + second))
            await until(lambda: len(history(heard)) == 3, 30)
            await until(lambda: now(heard) == "out_of_service", 30)
        finally:
            work.cancel()
            await asyncio.wait({work})
    assert list(history(heard).values()) == ["out_of_service", "normal", "out_of_service"]
    assert "NDEATH" in verbs(heard)[: verbs(heard).index("NBIRTH", 1)]


async def test_a_guest_is_not_born_and_does_not_end_the_node_that_runs(mosquitto, tmp_path):
    async with mosquitto_broker(mosquitto, tmp_path) as (port, _), host(port) as (_, heard):
        bus = connector(port)
        guest = type(bus)("plant", bus._options.as_guest(), {})
        async with bus.session() as session:
            async with guest.session():
                pass
            await session.publish(publication())
            await until(lambda: len(heard) == 3)
            assert verbs(heard) == ["NBIRTH", "DBIRTH", "DDATA"]
