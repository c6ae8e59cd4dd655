"""What is really told fits its schema and its page; the example consumer gets each alarm once."""

import asyncio
import contextlib
import json
import math
import re
import sys
import time

import pytest
from aiomqtt import Client
from buses import mosquitto_broker
from jsonschema import Draft202012Validator

from agent.alarms import Command, Event
from agent.runtime.agent import Agent
from agent.runtime.loop.workers import InlineExecutor
from agent.settings import settings_of
from connectors.checks.session import until
from connectors.mqtt.orders import OrderMessage
from tests.conftest import ROOT
from tests.unit.alarms.test_alarm import diagnosis
from tests.unit.connectors import test_mqtt_orders

SCHEMA = json.loads((ROOT / "config" / "payload.schema.json").read_text())
PAGE = (ROOT / "docs" / "payload.md").read_text()


def valid(payload, part=None):
    schema = SCHEMA if part is None else {"$ref": f"#/$defs/{part}", "$defs": SCHEMA["$defs"]}
    return Draft202012Validator(schema).is_valid(payload)


def fields_on_the_page(heading):
    section = PAGE.split(f"## {heading}\n")[1].split("\n## ")[0]
    rows = re.findall(r"^\| (`.*?) \|", section, re.MULTILINE)
    return {name for row in rows for name in re.findall(r"`(\w+)`", row)}


@contextlib.asynccontextmanager
async def running(port, **connection):
    """Run an agent that finds stiction in FIC101, and write its plant's values."""
    tags = {role: {"topic": "plant", "field": role, "time_field": "t"} for role in ("pv", "op")}
    loop = {
        "name": "FIC101",
        "connection": "broker",
        "ts": 1.0,
        "tags": tags,
        "window": {"seconds": 100.0},
        "quantify": "always",
        "alarm": {"on_delay": 1},
        "publish": [{"connection": "broker"}],
    }
    options = {"kind": "mqtt", "port": port, "client": "me", **connection}
    settings = settings_of({"connections": {"broker": options}, "loops": [loop]})
    agent = Agent(settings, InlineExecutor(), diagnose=lambda _: diagnosis("stiction"))
    work = asyncio.create_task(agent.run())
    try:
        async with Client("127.0.0.1", port) as plant:
            start = time.time() - 200
            for t in range(120):
                row = {"t": start + t, "pv": 50 + 5 * math.sin(t / 8), "op": 50 - 5 * math.cos(t / 8)}
                await plant.publish("plant", json.dumps(row), qos=1, retain=t == 0)
                await until(lambda: agent.connections[0].health.up, 30)
            yield agent, plant
    finally:
        work.cancel()
        await asyncio.wait({work})


async def test_what_is_reported_fits_the_schema_and_has_no_other_fields(mosquitto, tmp_path):
    told = []

    async def collect():
        async for message in client.messages:
            told.append((message.topic.value, json.loads(message.payload)))  # noqa: PERF401 - it never ends

    async with mosquitto_broker(mosquitto, tmp_path) as (port, _), Client("127.0.0.1", port) as client:
        await client.subscribe("slipjump/#", qos=1)
        task = asyncio.create_task(collect())
        async with running(port) as (agent, _):
            pipeline = agent._pipelines["FIC101"]
            await until(lambda: any(topic.endswith("/event") for topic, _ in told), 30)
            for event in (Event.ACKNOWLEDGE, Event.SHELVE, Event.REMOVE_FROM_SERVICE):
                ends = time.time() + 60 if event is Event.SHELVE else None
                pipeline.obey(Command(event, "jane", time.time(), ends))
            await until(lambda: told[-1][1].get("state") == "out_of_service", 30)
        await until(lambda: told[-1][1].get("status") == "offline", 30)
        task.cancel()
        await asyncio.wait({task})
    kinds = {"slipjump/me/status": "status", "slipjump/FIC101/alarm": "state"}
    seen = {}
    for topic, payload in told:
        kind = kinds.get(topic, "event")
        seen.setdefault(kind, []).append(payload)
        errors = [error.message for error in Draft202012Validator(SCHEMA).iter_errors(payload)]
        assert not errors, (topic, payload, errors)
        assert valid(payload, kind), (topic, payload)
        part = "status" if kind == "status" else "alarm"
        assert set(payload) == set(SCHEMA["$defs"][part]["properties"])
    assert [each["state"] for each in seen["event"]] == [
        "unacked_active",
        "acked_active",
        "shelved",
        "out_of_service",
    ]
    assert seen["event"][0]["s"] > 0
    assert [each["status"] for each in seen["status"]] == ["online", "offline"]


@pytest.mark.parametrize(
    "change",
    [
        {"schema": 3},
        {"state": "asleep"},
        {"s": "4"},
        {"s": -1},
        {"active": None},
        {"health": 5},
        {"loop": ""},
    ],
)
def test_the_schema_refuses_what_is_wrong(change):
    right = {
        **dict.fromkeys(SCHEMA["$defs"]["alarm"]["required"]),
        "schema": 2,
        "message_id": "A/1.000000/event/normal",
        "sequence": 7,
        "historical": False,
        "loop": "A",
        "active": False,
        "state": "normal",
        "priority": "low",
        "ne107": "normal",
        "health": 0,
        "time": 1.0,
        "advisory": "none",
    }
    assert valid(right)
    assert not valid(right | change)
    for name in right:
        assert not valid({key: value for key, value in right.items() if key != name})


def test_the_page_has_every_field_and_no_other():
    definitions = SCHEMA["$defs"]
    assert fields_on_the_page("Alarm") == set(definitions["alarm"]["properties"])
    assert fields_on_the_page("Status") == set(definitions["status"]["properties"])
    assert fields_on_the_page("Order") == set(definitions["order"]["properties"])
    assert set(OrderMessage.model_fields) == set(definitions["order"]["properties"])


def test_schema_and_program_agree_on_what_is_an_order():
    marks = {
        test.__name__: test.pytestmark[0].args[1]
        for test in (
            test_mqtt_orders.test_an_order_is_read,
            test_mqtt_orders.test_what_is_no_order_is_counted_and_the_first_is_reported,
        )
    }
    right, wrong = marks.values()
    assert all(valid(payload, "order") for payload, _ in right)
    beyond = ("tomorrow", math.inf)  # a schema says nothing of a time's form
    objects = [p for p, _ in wrong if isinstance(p, dict) and p.get("until") not in beyond]
    assert len(objects) > 8
    assert not any(valid(payload, "order") for payload in objects)


@contextlib.asynccontextmanager
async def example_consumer(port):
    """Run the consumer of the docs; yields the lines that it prints."""
    script = ROOT / "docs" / "examples" / "consumer.py"
    consumer = await asyncio.create_subprocess_exec(
        sys.executable, str(script), "--port", str(port), stdout=asyncio.subprocess.PIPE
    )
    lines = []

    async def read():
        async for line in consumer.stdout:
            lines.append(line.decode().strip())  # noqa: PERF401 - they are looked at meanwhile

    reading = asyncio.create_task(read())
    try:
        yield lines
    finally:
        consumer.kill()
        await consumer.wait()
        await reading


async def test_the_example_consumer_gets_each_alarm_once(mosquitto, tmp_path):
    """Also one that comes twice, and one that comes while it is away."""
    topic = "slipjump/FIC101/alarm/event"
    async with mosquitto_broker(mosquitto, tmp_path) as (port, _), Client("127.0.0.1", port) as client:
        await client.subscribe(topic, qos=1)
        ready = {"schema": 1, "client": "test", "status": "online", "session": 1.0, "time": 1.0}
        await client.publish("slipjump/test/status", json.dumps(ready), qos=1, retain=True)
        async with example_consumer(port) as lines:
            await until(lambda: "test is online" in lines, 30)
            async with running(port):
                event = bytes((await asyncio.wait_for(anext(client.messages), 30)).payload)
                await client.publish(topic, event, qos=1)
                other = {**json.loads(event), "message_id": "other", "by": "joe"}
                await client.publish(topic, json.dumps(other), qos=1)
                await until(lambda: any("by joe" in line for line in lines), 30)
        await client.publish(topic, json.dumps({**other, "message_id": "third", "by": "kim"}), qos=1)
        async with example_consumer(port) as later:
            await until(lambda: any("by kim" in line for line in later), 30)
            await until(lambda: "me is offline" in later, 30)
    alarms = [re.sub(r"^\S+ \S+ ", "", line) for line in lines if "FIC101" in line]
    assert alarms == ["FIC101 unacked_active, S 4, J 2", "FIC101 unacked_active, by joe, S 4, J 2"]
    assert not any("by joe" in line for line in later)
