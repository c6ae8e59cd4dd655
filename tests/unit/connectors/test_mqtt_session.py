"""What a session does with a broker that refuses, and with more messages than it reads."""

import asyncio
import math

from aiomqtt import Message

from connectors.base import LoopRole, Quality
from connectors.mqtt.client import Inbox
from connectors.mqtt.connector import MqttConnector, MqttSession
from connectors.mqtt.options import MqttOptions, MqttTag
from connectors.options import LoopTags


class GrudgingClient:
    """A broker that allows the first topic only, and has one message on it."""

    def __init__(self):
        self.messages = self._messages()

    async def subscribe(self, topics):
        return [1] + [0x80] * (len(topics) - 1)

    async def _messages(self):
        yield message("plant/pv", b"1.5")


def session_of(client, loop, **options):
    connector = MqttConnector("plant", MqttOptions(**options), {"FIC101": loop})
    return MqttSession(client, connector._readers, connector._topics, connector.orders)


def message(topic, payload):
    return Message(topic, payload, qos=1, retain=False, mid=1, properties=None)


async def test_a_topic_the_broker_refuses_is_reported_and_the_others_go_on():
    tags = {"pv": MqttTag(topic="plant/pv"), "op": MqttTag(topic="secret/op")}
    session = session_of(GrudgingClient(), LoopTags(tags))
    op, pv = [sample async for sample in session.samples()]
    assert (op.tag, op.quality, op.code) == (LoopRole("FIC101", "op"), Quality.BAD, 0x80)
    assert math.isnan(op.value)
    assert (pv.tag, pv.value) == (LoopRole("FIC101", "pv"), 1.5)


async def test_a_full_inbox_drops_what_is_new_and_says_so_once(caplog):
    inbox = Inbox(maxsize=2)
    for i in range(5):
        inbox.put_nowait(message("plant/pv", str(i).encode()))
    assert [inbox.get_nowait().payload for _ in range(2)] == [b"0", b"1"]
    assert isinstance(inbox, asyncio.Queue)
    assert [record.message for record in caplog.records] == [
        "topic plant/pv: messages are dropped, the reader is too slow"
    ]
