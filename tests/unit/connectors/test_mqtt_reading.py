"""A buffer brings the messages that paho reads one by one, and a message in one piece says the same."""

import json
import socket
import ssl

import pytest
from aiomqtt import Message
from hypothesis import given, settings
from hypothesis import strategies as st
from paho.mqtt.client import CallbackAPIVersion, Client, MQTTv5, MQTTv311
from paho.mqtt.enums import MQTTErrorCode
from paho.mqtt.packettypes import PacketTypes
from paho.mqtt.properties import Properties

from benchmarks.plant.broker import packet
from connectors.base import LoopRole
from connectors.mqtt import paho_private
from connectors.mqtt.messages.reader import TopicReader, readers_of
from connectors.mqtt.options import MqttTag
from connectors.mqtt.paho_private import AT_ONCE, IN_A_TURN, BufferedSocket, FastReading
from connectors.options import LoopTags
from connectors.readings import Readings

PINGRESP = b"\xd0\x00"
TOPICS = st.sampled_from([b"plant/FIC101", b"\xc3\xb6l", b"", b"plant/+", b"\xff\xfe", b"a" * 300])
PAYLOADS = st.one_of(st.binary(max_size=40), st.just(b"x" * 200), st.just(b"y" * 20_000))


@st.composite
def publications(draw, *, speaks_5):
    topic, payload, qos = draw(TOPICS), draw(PAYLOADS), draw(st.sampled_from([0, 0, 1, 1, 2]))
    body = len(topic).to_bytes(2, "big") + topic + (b"\x00\x07" if qos else b"")
    if speaks_5:
        properties = Properties(PacketTypes.PUBLISH)
        if draw(st.booleans()):
            properties.ContentType = "application/json"
        body += properties.pack()
    return packet(0x30 | qos << 1 | draw(st.booleans()), body + payload)


def streams(*, speaks_5):
    whole = st.one_of(publications(speaks_5=speaks_5), st.just(PINGRESP))
    junk = st.one_of(st.just(b""), st.binary(min_size=1, max_size=30), st.just(b"\x30\x02\x00\x09"))
    return st.tuples(st.lists(whole, max_size=12).map(b"".join), junk).map(b"".join)


class Wire:
    """A socket that gives what came in pieces of these sizes; then nothing, or the end."""

    def __init__(self, content, sizes):
        self.content, self.sizes, self.sent = content, [*sizes], b""
        self.there = 0

    def come(self):
        """Have the next piece come; returns whether there is one."""
        size = self.sizes.pop(0) if self.sizes else len(self.content)
        self.there = min(self.there + size, len(self.content))
        return bool(self.content)

    def recv(self, size):
        if not self.there:
            raise BlockingIOError
        found = self.content[: min(size, self.there)]
        self.content = self.content[len(found) :]
        self.there -= len(found)
        return found

    def send(self, data):
        self.sent += data
        return len(data)

    def close(self):
        self.content = b""

    def fileno(self):
        return -1


def received(content, sizes, *, speaks_5, fast):
    """What came, what was answered, how it ended."""
    client = Client(CallbackAPIVersion.VERSION2, protocol=MQTTv5 if speaks_5 else MQTTv311)
    client.on_socket_register_write = lambda *_: None
    found = []

    def put(message):
        found.append((message.topic.value, bytes(message.payload), message.qos, bool(message.retain)))

    def on_message(_client, _userdata, message):
        try:
            put(Message._from_paho_message(message))
        except ValueError:
            found.append("no topic")

    client.on_message = on_message
    wire = Wire(content, sizes)
    read = client.loop_read
    if fast:
        read = FastReading(client, put, speaks_5=speaks_5).read
    client._sock = BufferedSocket(wire) if fast else wire
    end = None
    try:
        while wire.come():
            while wire.there and client._sock is not None:
                end = read(1)
                assert not fast or client._sock is None or not client._sock.has_more
                if end is not MQTTErrorCode.MQTT_ERR_SUCCESS:
                    break
            if client._sock is None:
                break
    except Exception as error:  # noqa: BLE001 - paho raises what it likes
        end = type(error)
    answers = b"".join(each["packet"] for each in client._out_packet)
    return found, answers, end


SIZES = st.lists(st.integers(1, 400), max_size=20)


@pytest.mark.parametrize("speaks_5", [False, True])
def test_both_ways_read_the_same(speaks_5):
    @settings(max_examples=300, deadline=None)
    @given(streams(speaks_5=speaks_5), SIZES)
    def each(content, sizes):
        assert received(content, sizes, speaks_5=speaks_5, fast=True) == received(
            content, sizes, speaks_5=speaks_5, fast=False
        )

    each()


def test_the_installed_paho_has_every_member(monkeypatch):
    assert paho_private.missing() == [], "change connectors/mqtt/paho_private.py"
    monkeypatch.delattr(Client, "_packet_queue")
    assert paho_private.missing() == ["_packet_queue"]


def test_a_turn_reads_a_bounded_part_in_few_calls():
    """Hundreds of messages take one system call, and not all that came is read at once."""
    calls = []

    class Counting(Wire):
        def recv(self, size):
            calls.append(size)
            return super().recv(size)

    one = packet(0x30, b"\x00\x01a" + b"5" * 60)
    client = Client(CallbackAPIVersion.VERSION2)
    found = []
    client.on_message = lambda *each: found.append(each[-1])  # what begins in one turn and ends in the next
    reading = FastReading(client, found.append, speaks_5=False)
    wire = Counting(one * 10_000, [10**6])
    wire.come()
    client._sock = BufferedSocket(wire)
    reading.read()
    assert IN_A_TURN * (AT_ONCE // len(one)) <= len(found) <= IN_A_TURN * (AT_ONCE // len(one) + 1)
    assert len(calls) <= 2 * IN_A_TURN, "each second one is for the rest of the last message"
    while wire.there:
        reading.read()
    assert len(found) == 10_000


def test_the_end_and_a_reset_are_what_paho_makes_of_them():
    for ending in (b"", ConnectionResetError()):

        class Ending(Wire):
            def recv(self, _size, ending=ending):
                if isinstance(ending, bytes):
                    return ending
                raise ending

        client = Client(CallbackAPIVersion.VERSION2)
        reading = FastReading(client, lambda _: None, speaks_5=False)
        client._sock = BufferedSocket(Ending(b"", []))
        assert reading.read() is MQTTErrorCode.MQTT_ERR_CONN_LOST
        assert client._sock is None


def test_a_socket_of_tls_that_wants_more_has_nothing():
    class Wanting(Wire):
        def recv(self, _size):
            raise ssl.SSLWantReadError

    client = Client(CallbackAPIVersion.VERSION2)
    reading = FastReading(client, lambda _: None, speaks_5=False)
    client._sock = BufferedSocket(Wanting(b"", []))
    assert reading.read() is MQTTErrorCode.MQTT_ERR_SUCCESS
    assert client._sock is not None


def test_all_else_is_the_sockets():
    one, other = socket.socketpair()
    with one, other:
        buffered = BufferedSocket(one)
        assert buffered.fileno() == one.fileno()
        assert not hasattr(buffered, "pending"), "only sockets of TLS have it"


TAGS = {
    LoopRole("FIC101", role): MqttTag(topic="x", field=path, time_field="t")
    for role, path in (("pv", "pv"), ("op", "deep.op"), ("mode", "mode"))
}
VALUES = st.one_of(
    st.floats(0, 100), st.integers(-5, 5), st.sampled_from([True, None, "5", "AUTO", 10**400, [], {}])
)
MESSAGES = st.fixed_dictionaries(
    {"pv": VALUES, "mode": VALUES, "deep": st.fixed_dictionaries({"op": VALUES})},
    optional={"t": st.one_of(st.floats(0, 1e9), st.sampled_from(["2023-11-14T22:13:20Z", "now", None]))},
)


@settings(max_examples=400, deadline=None)
@given(
    st.lists(MESSAGES.map(lambda tree: json.dumps(tree).encode()) | st.sampled_from([b"", b"{", b"5"])),
    st.booleans(),
)
def test_a_message_in_one_piece_says_the_same(payloads, retained):
    whole, single = TopicReader(TAGS, whole=True), TopicReader(TAGS)
    for payload in payloads:
        found = whole.readings(payload, 1e3, retained=retained)
        samples = found.samples() if isinstance(found, Readings) else found
        assert repr(list(samples)) == repr(list(single.samples(payload, 1e3, retained=retained)))
        assert whole.malformed == single.malformed


def test_only_topics_with_whole_loops_and_one_time_are_one_piece():
    def tag(topic, field="pv", time_field="t"):
        return MqttTag(topic=topic, field=field, time_field=time_field if field else None)

    loops = {
        "A": LoopTags({"pv": tag("a"), "op": tag("a", "op")}),
        "B": LoopTags({"pv": tag("b"), "op": tag("c")}),
        "C": LoopTags({"pv": tag("d"), "op": tag("d", "op", "u")}),
        "D": LoopTags({"pv": tag("e", None), "op": tag("e", "op", None)}),
    }
    good = b'{"t": 1, "u": 1, "pv": 2, "op": 3}'
    pieces = {topic: each.readings(good, 5.0, retained=False) for topic, each in readers_of(loops).items()}
    assert [topic for topic, each in pieces.items() if isinstance(each, Readings)] == ["a"]
    assert isinstance(readers_of(loops)["a"].readings(good, 5.0, retained=True), Readings)
