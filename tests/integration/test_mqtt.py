"""What only MQTT has: retained state, events, brokers of others, messages of anybody."""

import asyncio
import json
import math

import pytest
from aiomqtt import Client
from buses import assert_same, connector_of, connector_to, mosquitto_broker, played, wave

from connectors.base import ConnectionLostError, LoopRole, Publication, Quality
from connectors.checks import Reader
from connectors.checks.session import until
from simulators.servers.broker import embedded_broker
from simulators.servers.mqtt import MqttServer

ROLES = ("pv", "op", "sp", "mode")
ALARM = {"active": True, "state": "unack_active", "loop": "FIC101", "s": 4.0, "j": math.nan}


def topics(port, **tags):
    publish = [{"connection": "plant", "topic": "site/{loop}/stiction"}]
    return connector_of(
        {"kind": "mqtt", "port": port}, [{"name": "FIC101", "tags": tags, "publish": publish}]
    )


@pytest.mark.parametrize("version", ["3.1.1", "5"])
async def test_every_row_arrives_through_mosquitto(mosquitto, tmp_path, version):
    sources = [wave("FIC101", 300)]
    async with (
        mosquitto_broker(mosquitto, tmp_path) as (port, _),
        MqttServer({"FIC101": ROLES}, port=port) as server,
    ):
        reading = await played(server, connector_to(server, ["FIC101"], version=version), sources)
    assert_same(reading, sources[0])


async def test_a_killed_mosquitto_is_reported(mosquitto, tmp_path):
    async with (
        mosquitto_broker(mosquitto, tmp_path) as (port, process),
        topics(port, pv={"topic": "a"}).session() as session,
        Reader(session) as reading,
    ):
        async with Client("127.0.0.1", port) as plant:
            await plant.publish("a", "1", qos=1, retain=True)
        await until(lambda: reading.samples)
        process.kill()
        with pytest.raises(ConnectionLostError):
            await reading.end(within=2.0)
        with pytest.raises(ConnectionLostError):
            await session.publish(Publication("FIC101", "state", "1", ALARM))


@pytest.mark.parametrize("broker", ["amqtt", "mosquitto"])
async def test_state_is_kept_for_who_comes_late_and_events_are_not(broker, request, tmp_path):
    which = (
        embedded_broker()
        if broker == "amqtt"
        else mosquitto_broker(request.getfixturevalue("mosquitto"), tmp_path)
    )
    async with which as running:
        port = running if broker == "amqtt" else running[0]
        async with Client("127.0.0.1", port) as early, topics(port).session() as session:
            await early.subscribe("site/#", qos=1)
            await session.publish(Publication("FIC101", "event", "1", ALARM))
            await session.publish(Publication("FIC101", "state", "1", ALARM))
            got = [await asyncio.wait_for(anext(early.messages), 5) for _ in range(2)]
        async with Client("127.0.0.1", port) as late:
            await late.subscribe("site/#", qos=1)
            kept = await asyncio.wait_for(anext(late.messages), 5)
            others = [await anext(late.messages) for _ in range(len(late.messages))]  # amqtt may say it twice
    assert [message.topic.value for message in got] == ["site/FIC101/stiction/event", "site/FIC101/stiction"]
    assert [message.qos for message in got] == [1, 1]
    assert {message.topic.value for message in (kept, *others)} == {"site/FIC101/stiction"}
    assert kept.retain
    assert json.loads(kept.payload) == {**ALARM, "j": None}


async def test_bare_numbers_and_garbage(caplog):
    async with embedded_broker() as port:
        tags = {"pv": {"topic": "plant/pv"}, "op": {"topic": "plant/op"}, "mode": {"topic": "plant/mode"}}
        async with (
            topics(port, **tags).session() as session,
            Reader(session) as reading,
            Client("127.0.0.1", port) as plant,
        ):
            await plant.publish("plant/pv", "1.5", qos=1, retain=True)
            await until(lambda: reading.of(LoopRole("FIC101", "pv")))
            await plant.publish("plant/op", b"\xff\xff", qos=1)
            await plant.publish("plant/op", b"\xff", qos=1)
            await plant.publish("plant/op", "50", qos=1)
            await plant.publish("plant/mode", "CAS", qos=1)
            await until(lambda: len(reading.samples) >= 5)
    assert [sample.value for sample in reading.of(LoopRole("FIC101", "pv"))][:1] == [1.5]
    assert [sample.quality for sample in reading.of(LoopRole("FIC101", "op"))] == [
        Quality.BAD,
        Quality.BAD,
        Quality.GOOD,
    ]
    assert reading.of(LoopRole("FIC101", "mode"))[0].value == "CAS"
    assert [record.message for record in caplog.records if record.name.startswith("connectors")] == [
        "topic plant/op: a message cannot be read as configured"
    ]
