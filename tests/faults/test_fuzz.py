"""Whatever is sent to a decoder: no crash, no good value out of nonsense, each counted, told once."""

import json
import logging
import math
import string
from datetime import UTC, datetime

import pytest
import yaml
from aiomqtt import Message
from asyncua import ua
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from agent.analysis.gates.record import too_short
from agent.runtime.intake.window import RollingWindow
from agent.settings.load import load_settings, settings_of
from connectors.base import ConfigError, LoopRole, Quality
from connectors.modbus.codec import decode, register_count
from connectors.modbus.options import ModbusTag
from connectors.mqtt.connector import MqttSession
from connectors.mqtt.messages.reader import TopicReader, readers_of
from connectors.mqtt.options import MqttTag
from connectors.mqtt.orders import OrderReader
from connectors.mqtt.topics import Topics
from connectors.opcua.values import change_of, is_waiting, sample
from connectors.options import LoopTags
from connectors.recording import RecordingError, read_recording
from tests.conftest import ROOT
from tests.unit.runtime.loops import loop_settings

FEW = settings(max_examples=50, deadline=None, suppress_health_check=list(HealthCheck))
MANY = settings(max_examples=10_000, deadline=None, suppress_health_check=list(HealthCheck))
OFTEN = (("few", FEW), pytest.param("many", MANY, marks=[pytest.mark.bench, pytest.mark.timeout(1200)]))

KEYS = ("t", "pv", "op", "x")
NUMBERS = st.floats() | st.integers() | st.integers(10**300, 10**310)
JSON = st.recursive(
    st.none() | st.booleans() | NUMBERS | st.text(max_size=20),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.sampled_from(KEYS), inner),
    max_leaves=12,
)
NASTY = (
    b"[" * 100_000,
    b'{"pv":' * 50_000,
    b"1" * 5000,
    b"1e999",
    b"\xff\xfe\x00",
    b'{"t": NaN, "pv": 1, "op": 1}',
    b'{"t": 1, "pv": Infinity, "op": NaN}',
    b'{"t": 1e400, "pv": 1, "op": 1}',
    b'{"t": "0000-99-99", "pv": 1, "op": 1}',
    b'{"t": true, "pv": 1, "op": 1}',
    b'{"t": [], "pv": {}, "op": []}',
    b" " * 10_000_000,
    b'"' + b"\\u0000" * 1000 + b'"',
)
TAGS = {LoopRole("FIC101", role): MqttTag(topic="x", field=role, time_field="t") for role in ("pv", "op")}


def malformed(payload):
    """Whether a message lacks the time, PV or OP; how these may be wrong is in NASTY."""
    if payload in NASTY:
        return True
    try:
        tree = json.loads(payload)
    except (ValueError, RecursionError):
        return True
    return not isinstance(tree, dict) or not {"t", "pv", "op"} <= tree.keys()


def as_bytes(tree):
    return json.dumps(tree).encode()


PAYLOADS = st.one_of(
    st.binary(min_size=1, max_size=200),
    st.sampled_from(NASTY),
    JSON.map(as_bytes),
    st.binary(max_size=5).map(lambda junk: b'{"t": 1, "pv": 2, "op"' + junk),
).filter(malformed)


@pytest.mark.parametrize(("_name", "often"), OFTEN, ids=lambda each: each if isinstance(each, str) else "")
def test_no_message_becomes_a_value_or_a_verdict(_name, often):
    reader, window = TopicReader(TAGS), RollingWindow(loop_settings(seconds=400.0))
    read, taken = [], []

    def values():
        return window.counters.samples - window.counters.bad

    @often
    @given(PAYLOADS)
    def each(payload):
        before = reader.malformed
        for arrival, got in enumerate(reader.samples(payload, 1e9, retained=False)):
            assert got.quality is Quality.BAD or math.isfinite(got.value)
            read.append(got)
            had = values()
            released = window.push(got, float(arrival))
            taken.append(max(values() - had, 0))  # a bad sample is counted as a gap
            assert released is None or too_short(window.cut(released).open())  # then nothing is said of it
        assert reader.malformed == before + 1

    each()
    assert read
    assert sum(taken) <= sum(got.quality is not Quality.BAD for got in read)


class Client:
    """A broker that has these messages, and then is gone."""

    def __init__(self, payloads):
        self.received = lambda: self._messages(payloads)

    async def subscribe(self, topics):
        return [1] * len(topics)

    async def _messages(self, payloads):
        for payload in payloads:
            yield Message("x", payload, qos=1, retain=False, mid=1, properties=None)


async def test_what_cannot_be_read_is_logged_once_and_counted(caplog):
    loops = {"FIC101": LoopTags({role: TAGS[LoopRole("FIC101", role)] for role in ("pv", "op")})}
    topics = Topics({}, {}, None, "slipjump")
    readers = readers_of(loops)
    session = MqttSession(Client(NASTY * 20), readers, topics, OrderReader({}))
    with caplog.at_level(logging.WARNING):
        got = [each async for each in session.samples()]
    assert {each.quality for each in got} <= {Quality.BAD}
    assert [reader.malformed for reader in readers.values()] == [20 * len(NASTY)]
    assert len([each for each in caplog.records if "cannot be read" in each.message]) == 1


TYPES = ("int16", "uint16", "int32", "uint32", "int64", "uint64", "float32", "float64")


@FEW
@given(st.sampled_from(TYPES), st.sampled_from(["ABCD", "CDAB", "BADC", "DCBA"]), st.data())
def test_any_registers_are_a_number(kind, order, data):
    count = register_count(kind)
    registers = data.draw(st.lists(st.integers(0, 65535), min_size=count, max_size=count))
    assert isinstance(decode(registers, kind, order), float)


@FEW
@given(st.dictionaries(st.sampled_from(list(ModbusTag.model_fields)), JSON))
def test_no_tag_of_modbus_crashes_its_model(entry):
    loop = {"name": "A", "connection": "u", "ts": 1, "tags": {"pv": entry, "op": entry}}
    with pytest.raises(ConfigError):
        settings_of({"connections": {"u": {"kind": "modbus"}}, "loops": [loop, loop]})


STAMPS = st.none() | st.datetimes(datetime(1601, 1, 1), datetime(9999, 12, 31))  # noqa: DTZ001
VALUES = st.one_of(
    st.none(),
    st.sampled_from(
        [
            (ua.VariantType.Double, [1.0, 2.0]),
            (ua.VariantType.Boolean, True),
            (ua.VariantType.ByteString, b"\x00\xff"),
            (ua.VariantType.DateTime, datetime(2026, 1, 1, tzinfo=UTC)),
            (ua.VariantType.NodeId, ua.NodeId(1, 2)),
            (ua.VariantType.LocalizedText, ua.LocalizedText("x")),
            (ua.VariantType.StatusCode, ua.StatusCode(0x80000000)),
            (ua.VariantType.UInt64, 2**64 - 1),
        ]
    ),
    st.floats().map(lambda value: (ua.VariantType.Double, value)),
    st.text().map(lambda value: (ua.VariantType.String, value)),
)


@pytest.mark.parametrize(("_name", "often"), OFTEN, ids=lambda each: each if isinstance(each, str) else "")
def test_no_value_of_opc_ua_is_more_than_it_is(_name, often):
    @often
    @given(VALUES, st.integers(0, 2**32 - 1) | st.none(), STAMPS, STAMPS)
    def each(value, status, source, server):
        data = ua.DataValue(
            None if value is None else ua.Variant(value[1], value[0]),
            None if status is None else ua.StatusCode(status),
            source,
            server,
        )
        change = change_of(data)
        is_waiting(change)
        for tag in (LoopRole("FIC101", "pv"), LoopRole("FIC101", "mode")):
            got = sample(tag, change)
            assert math.isfinite(got.time)
            if got.quality is not Quality.BAD:
                assert status is None or status >> 30 < 2
                is_text = tag.role == "mode" and isinstance(value[1], str)
                assert isinstance(got.value, str) if is_text else math.isfinite(got.value)

    each()


CELLS = st.one_of(
    st.text(st.characters(exclude_categories=["Cs"]), max_size=8),
    st.floats().map(str),
    st.sampled_from(["", "Bad", "NaN", "1,5", "2026-01-01", "1e400", "-0", "0x10", "\ufeff1", '"', "\x00"]),
)
ROWS = st.lists(st.lists(CELLS, min_size=1, max_size=5).map(",".join), max_size=30).map("\n".join)


@pytest.mark.parametrize("ending", ["csv", "parquet"])
def test_no_file_crashes_the_reader_of_recordings(tmp_path, ending):
    path = tmp_path / f"any.{ending}"

    @FEW
    @given(st.binary(max_size=300) | ROWS.map(lambda rows: b"time,OP,PV\n" + rows.encode()))
    def each(content):
        path.write_bytes(content)
        try:
            read_recording(path)
        except RecordingError as error:
            assert str(path) in str(error)  # noqa: PT017
            assert "\n" not in str(error)  # noqa: PT017

    each()


SETTINGS = ("agent", "connections", "loops", "kind", "tags", "pv", "op", "modbus", "name", "ts")
EXAMPLE = (ROOT / "config" / "example.yaml").read_text()
TREES = st.recursive(
    st.none() | st.booleans() | NUMBERS | st.text(string.printable, max_size=8) | st.dates(),
    lambda inner: (
        st.lists(inner, max_size=3)
        | st.dictionaries(
            st.sampled_from(
                ["agent", "connections", "loops", "kind", "tags", "pv", "op", "modbus", "name", "ts"]
            )
            | st.none(),
            inner,
            max_size=5,
        )
    ),
    max_leaves=20,
)
BAD_YAML = (
    "[" * 20_000,
    "agent: {workers: " + "9" * 5000 + "}",
    "loops: 2001-99-99",
    "? [a]\n: b",
    "a: &a [*a]",
    "connections: &c {u: *c}",
    "\x00",
    "loops: !!python/object:os.system {}",
    "2001-12-14t21:59:43.10-99:99",
)


@pytest.mark.parametrize(("_name", "often"), OFTEN, ids=lambda each: each if isinstance(each, str) else "")
def test_no_configuration_crashes_the_loader(tmp_path, _name, often):
    path = tmp_path / "plant.yaml"

    def loaded(text):
        path.write_text(text, encoding="utf-8", errors="surrogateescape")
        try:
            load_settings(path)
        except ConfigError as error:
            assert error.faults  # noqa: PT017
            assert all(fault.startswith(str(path)) for fault in error.faults)  # noqa: PT017

    for text in BAD_YAML:
        loaded(text)

    @often
    @given(TREES | st.none(), st.integers(0, len(EXAMPLE)), st.text(string.printable, max_size=6))
    def each(tree, at, junk):
        if tree is not None:
            loaded(yaml.safe_dump(tree, allow_unicode=True))
        else:
            loaded(EXAMPLE[:at] + junk + EXAMPLE[at + len(junk) :])

    each()
