"""What a session does with a broker that refuses, and with more messages than it reads."""

import asyncio
import math

from aiomqtt import Message

from connectors.base import LoopRole, Quality
from connectors.mqtt.connector import MqttConnector, MqttSession
from connectors.mqtt.inbox import Inbox, Losses
from connectors.mqtt.options import MqttOptions, MqttTag
from connectors.options import LoopTags


class GrudgingClient:
    """A broker that allows the first topic only, and has one message on it."""

    def __init__(self):
        self.received = self._messages

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


async def test_a_flooded_topic_leaves_room_for_its_neighbours_and_what_is_lost_is_counted(caplog):
    losses = Losses()
    inbox = Inbox(4, losses)
    for i in range(5):
        inbox.put_nowait(message("plant/flood", str(i).encode()))
    for i in range(2):
        inbox.put_nowait(message(f"plant/quiet{i}", b"7"))
    assert losses.count == 3
    read = [inbox.get_nowait() for _ in range(inbox.qsize())]
    assert [each.payload for each in read] == [b"0", b"1", b"7", b"7"]  # in the order in which they came
    for i in range(3):  # what was read makes room again
        inbox.put_nowait(message("plant/flood", str(i).encode()))
    assert inbox.qsize() == 2
    assert losses.count == 4
    assert isinstance(inbox, asyncio.Queue)
    assert [record.message for record in caplog.records] == [
        "topic plant/flood: messages are discarded, they come faster than they are read"
    ]


def test_losses_are_counted_over_all_sessions_of_a_connector():
    connector = MqttConnector("plant", MqttOptions(), {})
    assert connector.lost == 0
    connector._losses.note("plant/pv")
    assert connector.lost == 1
