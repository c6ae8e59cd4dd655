"""A Sparkplug session whose broker is in memory: order under load, and commands of anybody."""

import asyncio
import random
from itertools import pairwise

import pytest
from aiomqtt import Message
from hypothesis import example, given
from hypothesis import strategies as st

from connectors.base import Order, Publication
from connectors.options import LoopTags
from connectors.sparkplug.connector import SparkplugConnector, SparkplugSession
from connectors.sparkplug.metrics import COMMANDS, OUT_OF_SERVICE, REBIRTH
from connectors.sparkplug.options import SparkplugOptions, SparkplugTarget
from connectors.sparkplug.payload import DataType, MalformedMetricsError, Metric, decode, encode
from tests.faults.test_fuzz import OFTEN

NCMD, DCMD = "spBv1.0/plant/NCMD/gate", "spBv1.0/plant/DCMD/gate/FIC101"
REBORN = encode([Metric(REBIRTH, value=True, type=DataType.BOOLEAN)], 1.0)


class Broker:
    """Takes its time with each message, and has some of its own."""

    def __init__(self, *messages):
        self.sent = []
        self.messages = self._messages(messages)
        self._random = random.Random(1)

    async def send(self, message):
        for _ in range(self._random.randrange(4)):
            await asyncio.sleep(0)
        self.sent.append((message.topic.split("/")[2], decode(message.payload)))

    async def subscribe(self, topics):
        await asyncio.sleep(0)
        return [0] * len(topics)

    async def _messages(self, messages):
        for topic, payload in messages:
            await asyncio.sleep(0)
            yield Message(topic, payload, qos=0, retain=False, mid=1, properties=None)


def session_on(broker, *, orders=True):
    options = SparkplugOptions(group="plant", node="gate", orders=orders)
    loops = {f"FIC10{k}": LoopTags({}, [SparkplugTarget(connection="scada")]) for k in (1, 2)}
    connector = SparkplugConnector("scada", options, loops)
    return connector, SparkplugSession(broker, connector, connector._node, orders=orders)


async def commanded(session):
    return [order async for order in session.samples()]


async def test_births_that_a_host_requests_amid_data_break_no_order():
    broker = Broker(*[(NCMD, REBORN)] * 20)
    _, session = session_on(broker)

    async def tell(loop):
        for n in range(100):
            await session.publish(Publication(loop, "state", str(n), {"sequence": n}))

    await session.born()
    await asyncio.gather(commanded(session), tell("FIC101"), tell("FIC102"))
    verbs = [verb for verb, _ in broker.sent]
    births = [k for k, verb in enumerate(verbs) if verb == "NBIRTH"]
    assert len(births) == 21
    assert verbs.count("DDATA") == 200
    assert births[-1] < len(verbs) - 3, "data are told among the births"
    assert all(verbs[k : k + 3] == ["NBIRTH", "DBIRTH", "DBIRTH"] for k in births)
    assert all(broker.sent[k][1].seq == 0 for k in births)
    assert all(
        after.seq == (before.seq + 1) % 256
        for (_, before), (verb, after) in pairwise(broker.sent)
        if verb != "NBIRTH"
    )


async def test_what_nobody_requested_is_left_aside():
    """amqtt was seen to send it."""
    broker = Broker(("plant", b"1"), ("spBv1.0/plant/DCMD/other/FIC101", REBORN), (f"{DCMD}9", b"\xff"))
    connector, session = session_on(broker)
    assert await commanded(session) == []
    assert (connector.malformed, broker.sent) == (0, [])


NAMES = st.sampled_from([*COMMANDS, OUT_OF_SERVICE, "Alarm/Id", REBIRTH, "x", ""])
TYPED = st.one_of(
    st.tuples(st.just(DataType.BOOLEAN), st.booleans()),
    st.tuples(st.just(DataType.DOUBLE), st.none() | st.floats()),
    st.tuples(st.just(DataType.STRING), st.text(st.characters(exclude_categories=["Cs"]), max_size=300)),
    st.tuples(st.just(DataType.INT64), st.integers(-(2**63), 2**63 - 1)),
)
METRICS = st.tuples(NAMES, TYPED).map(lambda each: Metric(each[0], each[1][1], each[1][0]))
COMMANDED = st.lists(METRICS, max_size=4).map(lambda each: encode(each, 1.0))
CHANGED = st.tuples(COMMANDED.filter(len), st.integers(0, 500), st.integers(1, 255)).map(
    lambda each: bytes(b ^ each[2] * (k == each[1] % len(each[0])) for k, b in enumerate(each[0]))
)
CUT = st.tuples(COMMANDED, st.integers(1, 20)).map(lambda each: each[0][: -each[1]])
PAYLOADS = st.binary(max_size=100) | COMMANDED | CHANGED | CUT


@pytest.mark.parametrize(("_name", "often"), OFTEN, ids=lambda each: each if isinstance(each, str) else "")
def test_commands_of_anybody_are_obeyed_or_counted_and_the_first_is_reported(_name, often, caplog):
    def unreadable(raw):
        try:
            decode(raw)
        except MalformedMetricsError:
            return True
        return False

    garbled, obeyed = [], []

    @often
    @given(st.sampled_from([NCMD, DCMD]), PAYLOADS)
    @example(NCMD, REBORN)  # few draws may well mean nothing
    def each(topic, payload):
        caplog.clear()
        broker = Broker(*[(topic, payload)] * 2)
        connector, session = session_on(broker)
        orders = runner.run(commanded(session))
        assert all(isinstance(order, Order) and order.by and order.subject == "FIC101" for order in orders)
        assert connector.malformed in {0, 2}
        assert len(caplog.records) == bool(connector.malformed)
        if unreadable(payload):
            assert (connector.malformed, orders, broker.sent) == (2, [], [])
        garbled.append(connector.malformed)
        obeyed.append(len(orders) + len(broker.sent))

    with asyncio.Runner() as runner:
        each()
    assert any(garbled)
    assert any(obeyed)
