"""Status and orders over a real broker, and what MQTT 5 adds."""

import asyncio
import contextlib
import json
import math
import socket
import time

import pytest
from aiomqtt import Client, ProtocolVersion
from buses import connector_of, mosquitto_broker

from agent.alarms import State
from agent.runtime.agent import Agent
from agent.runtime.commission.probe import probe
from agent.runtime.loop.workers import InlineExecutor
from agent.settings import settings_of
from connectors.base import Order, Publication, RefusedError
from connectors.checks import Reader
from connectors.checks.session import until
from tests.unit.runtime.agents import judged

ALARM = {"schema": 1, "active": True, "s": 4.0, "j": math.nan}
each_version = pytest.mark.parametrize("version", ["3.1.1", "5"])


def connector(port, **options):
    loop = {"name": "FIC101", "tags": {}, "publish": [{"connection": "plant"}]}
    return connector_of({"kind": "mqtt", "port": port, "client": "me", **options}, [loop])


@contextlib.asynccontextmanager
async def listening(port, *topics, version="3.1.1"):
    """Subscribe, and collect what comes: topic -> messages."""
    got = {}
    protocol = ProtocolVersion.V5 if version == "5" else ProtocolVersion.V311

    async def collect():
        async for message in client.messages:
            got.setdefault(message.topic.value, []).append(message)

    async with Client("127.0.0.1", port, protocol=protocol) as client:
        await client.subscribe([(topic, 1) for topic in topics])
        task = asyncio.create_task(collect())
        try:
            yield got
        finally:
            task.cancel()
            await asyncio.wait({task})


def said(got, topic="slipjump/me/status"):
    return [json.loads(message.payload) for message in got.get(topic, [])]


@each_version
async def test_birth_end_and_last_will_are_reported_and_kept(mosquitto, tmp_path, version):
    async with mosquitto_broker(mosquitto, tmp_path) as (port, _):
        bus = connector(port, version=version)
        async with listening(port, "slipjump/#") as got:
            async with bus.session():
                await until(lambda: len(said(got)) == 1)
            await until(lambda: len(said(got)) == 2)
            with contextlib.suppress(Exception):
                async with bus.session() as session:
                    await until(lambda: len(said(got)) == 3)
                    session._client._client.socket().shutdown(socket.SHUT_RDWR)
                    await until(lambda: len(said(got)) == 4)
            told = said(got)
        async with listening(port, "slipjump/#") as late:
            await until(lambda: late)
    assert [each["status"] for each in told] == ["online", "offline", "online", "offline"]
    assert {each["client"] for each in told} == {"me"}
    first, second = told[0]["session"], told[2]["session"]
    assert [each["session"] for each in told] == [first, first, second, second]
    assert first < second
    assert [each["time"] is None for each in told] == [False, False, False, True]
    assert said(late) == told[-1:]
    assert late["slipjump/me/status"][0].retain


async def test_a_client_that_comes_again_before_the_broker_knows_is_online(mosquitto, tmp_path):
    """Its name is the same, so the broker tells the will of the former before the birth of the new one."""
    async with mosquitto_broker(mosquitto, tmp_path) as (port, _):
        bus = connector(port)
        async with listening(port, "slipjump/#") as got, bus.session():
            await until(lambda: len(said(got)) == 1)
            async with bus.session():
                await until(lambda: len(said(got)) == 3)
                told = said(got)
    assert [each["status"] for each in told] == ["online", "offline", "online"]


async def test_a_look_at_the_configuration_does_not_disturb_the_agent_that_runs(mosquitto, tmp_path):
    async with mosquitto_broker(mosquitto, tmp_path) as (port, _):
        tag = {"topic": "plant", "field": "pv"}
        settings = settings_of(
            {
                "connections": {"plant": {"kind": "mqtt", "port": port, "client": "me", "orders": True}},
                "loops": [
                    {"name": "FIC101", "connection": "plant", "ts": 1.0, "tags": {"pv": tag, "op": tag}}
                ],
            }
        )
        async with listening(port, "slipjump/#") as got, connector(port).session() as session:
            await session._client.publish("plant", '{"pv": 1.0}', qos=1, retain=True)
            found = await probe(settings, 10.0)
            await session.publish(Publication("FIC101", "state", "1", ALARM))
            await until(lambda: "slipjump/FIC101/alarm" in got)
            assert [each["status"] for each in said(got)] == ["online"]
    assert [(each.place, each.problems) for each in found] == [("", ()), ("pv", ()), ("op", ())]


async def test_what_mqtt_5_adds(mosquitto, tmp_path):
    async with mosquitto_broker(mosquitto, tmp_path) as (port, _):
        bus = connector(port, version="5", topic="a/{loop}")
        async with listening(port, "a/#", version="5") as got, bus.session() as session:
            await session.publish(Publication("FIC101", "state", "1", ALARM))
            await until(lambda: got)
    (message,) = got["a/FIC101"]
    assert message.properties.ContentType == "application/json"
    assert message.properties.PayloadFormatIndicator == 1
    assert message.properties.UserProperty == [("schema", "1")]
    assert not hasattr(message.properties, "MessageExpiryInterval")
    assert json.loads(message.payload) == {**ALARM, "j": None}


async def test_a_broker_that_does_not_take_it_says_so_with_mqtt_5(mosquitto, tmp_path, caplog):
    rights = tmp_path / "acl"
    rights.write_text("topic read #\ntopic write open/#\n")
    more = ("user root", "allow_anonymous true", f"acl_file {rights}")  # else it cannot read the file
    async with mosquitto_broker(mosquitto, tmp_path, more) as (port, _):
        async with connector(port, version="5", topic="secret/{loop}").session() as session:
            with pytest.raises(RefusedError, match=r"secret/FIC101: Not authorized"):
                await session.publish(Publication("FIC101", "state", "1", ALARM))
        async with connector(port, version="5", topic="open/{loop}").session() as session:
            await session.publish(Publication("FIC101", "state", "1", ALARM))
    assert "the status cannot be published: topic slipjump/me/status: Not authorized" in caplog.text


async def test_orders_are_read_and_retained_ones_are_not(mosquitto, tmp_path):
    topic = "slipjump/FIC101/alarm/order"
    async with mosquitto_broker(mosquitto, tmp_path) as (port, _), Client("127.0.0.1", port) as person:
        await person.publish(topic, json.dumps({"action": "unshelve", "by": "ghost"}), qos=1, retain=True)
        bus = connector(port, orders=True)
        assert bus.takes_orders
        async with bus.session() as session, Reader(session) as reading:
            await until(lambda: bus.orders.retained == 1)
            for number in ("1", "1", "2"):
                order = {"action": "acknowledge", "by": "jane", "id": number}
                await person.publish(topic, json.dumps(order), qos=1)
            await person.publish(topic, b"\xff", qos=1)
            await until(lambda: bus.malformed == 1)
    assert reading.orders == [Order("FIC101", "acknowledge", "jane")] * 2
    assert (bus.orders.repeated, bus.orders.retained) == (1, 1)


async def test_a_person_acknowledges_over_the_bus_and_the_bus_reports_it(mosquitto, tmp_path):
    """The whole agent: an alarm is raised, somebody who saw it orders, and the next state says by whom."""
    async with mosquitto_broker(mosquitto, tmp_path) as (port, _), Client("127.0.0.1", port) as plant:
        tags = {role: {"topic": "plant", "field": role, "time_field": "t"} for role in ("pv", "op")}
        settings = settings_of(
            {
                "connections": {
                    "field": {"kind": "mqtt", "port": port},
                    "scada": {"kind": "mqtt", "port": port, "orders": True, "topic": "site/{area}/{loop}"},
                },
                "loops": [
                    {
                        "name": "FIC101",
                        "connection": "field",
                        "ts": 1.0,
                        "tags": tags,
                        "variables": {"area": "a1"},
                        "window": {"seconds": 100.0},
                        "alarm": {"on_delay": 1},
                        "publish": [{"connection": "scada"}],
                    }
                ],
            }
        )
        agent = Agent(settings, InlineExecutor(), diagnose=judged("stiction"))
        work = asyncio.create_task(agent.run())
        try:
            async with listening(port, "site/#") as got:
                start = time.time() - 200
                for t in range(120):
                    row = {"t": start + t, "pv": 50 + 5 * math.sin(t / 8), "op": 50 - 5 * math.cos(t / 8)}
                    await plant.publish("plant", json.dumps(row), qos=1, retain=t == 0)
                    await until(lambda: all(each.health.up for each in agent.connections), 30)
                await until(lambda: said(got, "site/a1/FIC101/event"), 30)
                alarm = said(got, "site/a1/FIC101/event")[0]
                order = {"action": "acknowledge", "by": "jane", "alarm": alarm["id"]}
                await plant.publish("site/a1/FIC101/order", json.dumps({**order, "alarm": "x"}), qos=1)
                await plant.publish("site/a1/FIC101/order", json.dumps(order), qos=1)
                await until(lambda: len(said(got, "site/a1/FIC101/event")) == 2, 30)
                acknowledged = said(got, "site/a1/FIC101/event")[1]
        finally:
            work.cancel()
            await asyncio.wait({work})
    assert (alarm["state"], alarm["by"]) == (State.UNACKED_ACTIVE, None)
    assert (acknowledged["state"], acknowledged["by"]) == (State.ACKED_ACTIVE, "jane")
    assert acknowledged["id"] == alarm["id"]
    assert (agent.orders.taken, agent.orders.refused) == (1, 1)
