"""Both decoders of a publish response say the same of all bytes, and rows say what their samples say."""

import logging
import math
from datetime import UTC, datetime, timedelta

import numpy as np
import pytest
from asyncua import ua
from asyncua.client.ua_session import UaSession
from asyncua.common.utils import Buffer
from asyncua.ua.ua_binary import struct_from_binary, struct_to_binary
from hypothesis import given, settings
from hypothesis import strategies as st

from connectors.base import LoopRole
from connectors.opcua import asyncua_private
from connectors.opcua.asyncua_private import decoded, publish_fast
from connectors.opcua.notification import NodeChanges, NodeValue, ValueBlock
from connectors.opcua.rows import LoopRows
from connectors.opcua.values import change_of, is_waiting, sample
from connectors.readings import Readings

Kind = ua.VariantType
BEGINS = datetime(1601, 1, 1, tzinfo=UTC)
NUMBERS = {
    Kind.Boolean: st.booleans(),
    Kind.SByte: st.integers(-(2**7), 2**7 - 1),
    Kind.Byte: st.integers(0, 2**8 - 1),
    Kind.Int16: st.integers(-(2**15), 2**15 - 1),
    Kind.UInt16: st.integers(0, 2**16 - 1),
    Kind.Int32: st.integers(-(2**31), 2**31 - 1),
    Kind.UInt32: st.integers(0, 2**32 - 1),
    Kind.Int64: st.integers(-(2**63), 2**63 - 1),
    Kind.Float: st.floats(width=32),
    Kind.Double: st.floats(),
    Kind.String: st.text(max_size=5),
}
PLAIN = st.sampled_from([Kind.Boolean, Kind.Int16, Kind.UInt32, Kind.Float, Kind.Double])
VARIANTS = st.sampled_from([*NUMBERS]).flatmap(
    lambda kind: NUMBERS[kind].map(lambda value: ua.Variant(value, kind))
)
OTHERS = st.just(ua.Variant([1.0, 2.0], Kind.Double)) | st.just(ua.Variant(None, Kind.Null))
TIMES = st.none() | st.datetimes(BEGINS.replace(tzinfo=None), timezones=st.just(UTC))


@st.composite
def data_values(draw):
    source, server = draw(TIMES), draw(TIMES)
    made = ua.DataValue(
        draw(VARIANTS | VARIANTS | OTHERS),
        draw(st.none() | st.sampled_from([0, 0, 0x408F0000, 0x80000000, 0x80320000]).map(ua.StatusCode)),
        source,
        server,
    )
    # asyncua has the order of picoseconds wrong where there is a time of the server behind
    if source is not None and draw(st.booleans()):
        made.SourcePicoseconds = draw(st.integers(0, 9999))
    if server is not None and draw(st.booleans()):
        made.ServerPicoseconds = draw(st.integers(0, 9999))
    return made


@st.composite
def alike(draw):
    """Enough of one layout for numpy, and some others before and behind."""
    kind, status, times = draw(PLAIN), draw(st.sampled_from([None, 0, 0x80000000])), draw(TIMES | TIMES)
    numbers = draw(st.lists(NUMBERS[kind], min_size=6, max_size=20))
    made = [
        ua.DataValue(ua.Variant(each, kind), None if status is None else ua.StatusCode(status), times)
        for each in numbers
    ]
    for each in made[draw(st.integers(0, 20)) :]:
        each.ServerTimestamp = draw(st.just(None) | TIMES)
    others = st.lists(data_values(), max_size=2)
    return [*draw(others), *made, *draw(others)]


@st.composite
def responses(draw):
    changes = [
        ua.DataChangeNotification(
            [
                ua.MonitoredItemNotification(draw(st.integers(0, 2**32 - 1)), each)
                for each in draw(st.lists(data_values(), max_size=8) | alike())
            ]
        )
        for _ in range(draw(st.integers(0, 2)))
    ]
    if draw(st.integers(0, 5)) == 0:
        changes.append(ua.StatusChangeNotification())
    parameters = ua.PublishResult(
        draw(st.integers(0, 2**32 - 1)),
        draw(st.lists(st.integers(0, 9), max_size=3)),
        draw(st.booleans()),
        ua.NotificationMessage(draw(st.integers(0, 9)), BEGINS + timedelta(days=1), changes),
        draw(st.lists(st.sampled_from([0, 0x80000000]).map(ua.StatusCode), max_size=2)),
    )
    header = ua.ResponseHeader(RequestHandle=draw(st.integers(0, 9)))
    if draw(st.integers(0, 5)) == 0:
        header.StringTable = ["x"]
    return bytes(struct_to_binary(ua.PublishResponse(ResponseHeader=header, Parameters=parameters)))


def content(response):
    """All that is used of a response, comparable also where a number is NaN."""
    found, message = response.Parameters, response.Parameters.NotificationMessage
    parts = []
    for each in message.NotificationData or []:
        if isinstance(each, NodeChanges):
            for part in each.parts:
                items = part.items() if isinstance(part, ValueBlock) else part
                parts += [_float(*item) if isinstance(item, tuple) else _pair(item) for item in items]
        elif isinstance(each, ua.DataChangeNotification):
            parts += [_pair(item) for item in each.MonitoredItems]
        else:
            parts.append(each)
    rest = (message.SequenceNumber, message.PublishTime, [each.value for each in found.Results or []])
    head = (found.SubscriptionId, found.AvailableSequenceNumbers or [], found.MoreNotifications)
    return repr((head, parts, rest))


def _pair(item):
    return _float(item.ClientHandle, change_of(item.Value))


def _float(handle, change):
    """As a sample has it."""
    number = isinstance(change.value, int | float)
    return handle, change._replace(value=float(change.value)) if number else change


def by_asyncua(data):
    try:
        return content(struct_from_binary(ua.PublishResponse, Buffer(data)))
    except Exception as error:  # noqa: BLE001 - asyncua raises what it likes
        return type(error)


@settings(max_examples=200, deadline=None)
@given(responses())
def test_both_say_the_same(data):
    fast = decoded(Buffer(data))
    assert fast is None or content(fast) == by_asyncua(data)


@settings(max_examples=400, deadline=None)
@given(responses(), st.data())
def test_bytes_that_no_server_may_send_are_left_to_asyncua_or_say_the_same(data, draw):
    broken = bytearray(data)
    for _ in range(draw.draw(st.integers(1, 3))):
        broken[draw.draw(st.integers(0, len(broken) - 1))] = draw.draw(st.integers(0, 255))
    broken = bytes(broken[: draw.draw(st.integers(len(broken) // 2, len(broken)))])
    fast = decoded(Buffer(broken))
    assert fast is None or content(fast) == by_asyncua(broken)


def plain(count=3, kind=Kind.Double, status=None):
    values = [ua.DataValue(ua.Variant(float(k), kind), status, BEGINS) for k in range(count)]
    items = [ua.MonitoredItemNotification(k, each) for k, each in enumerate(values)]
    message = ua.NotificationMessage(7, BEGINS, [ua.DataChangeNotification(items)])
    return ua.PublishResponse(Parameters=ua.PublishResult(5, [7], False, message))


def test_what_is_plain_takes_the_short_way_and_one_that_is_not_goes_alone():
    response = plain()
    response.Parameters.NotificationMessage.NotificationData[0].MonitoredItems[1].Value = ua.DataValue("text")
    fast = decoded(Buffer(struct_to_binary(response)))
    (changes,) = fast.Parameters.NotificationMessage.NotificationData
    (items,) = changes.parts
    assert [isinstance(item, tuple) for item in items] == [True, False, True]
    assert items[2] == (2, NodeValue(2.0, 0, BEGINS.timestamp()))


class Session(UaSession):
    """Has this answer."""

    def __init__(self, answer):
        self.answer = answer
        self.logger = logging.getLogger("asyncua.test")

    async def _send_request(self, request, timeout=0):  # noqa: ARG002, ASYNC109
        return Buffer(self.answer)


async def test_an_answer_that_cannot_be_read_is_what_asyncua_makes_of_it():
    good, bad = struct_to_binary(plain()), struct_to_binary(plain())[:-9]
    for answer, fails in ((good, False), (bad, True)):
        own, theirs = Session(answer), Session(answer)
        publish_fast(own)
        if not fails:
            assert content(await own.publish([])) == content(await theirs.publish([]))
            continue
        errors = []
        for session in (own, theirs):
            with pytest.raises(Exception) as raised:  # noqa: PT011 - the same, whichever
                await session.publish([])
            errors.append((raised.type, type(raised.value.__cause__)))
        assert errors[0] == errors[1]


def test_the_installed_asyncua_has_every_member(monkeypatch):
    assert asyncua_private.missing() == [], "change connectors/opcua/asyncua_private.py"
    monkeypatch.delattr(UaSession, "_send_request")
    assert asyncua_private.missing() == ["UaSession._send_request"]


TAGS = {
    "a": [LoopRole("A", "pv")],
    "b": [LoopRole("A", "op")],
    "c": [LoopRole("A", "sp"), LoopRole("B", "sp")],
    "d": [LoopRole("B", "pv")],
}
VALUES = st.sampled_from([1.0, 2, True, math.nan, "text", None, 3.5])
CHANGES = st.tuples(
    st.sampled_from([*TAGS]),
    st.builds(
        NodeValue,
        VALUES,
        st.sampled_from([0, 0, 0, 0x40000000, 0x80000000]),
        st.sampled_from([1.0, 1.0, 2.0]),
    ),
)


STEPS = st.lists(st.sampled_from([0.0, 0.0, 1.0]), min_size=12, max_size=12)


def flat(pieces):
    """Samples in their order."""
    return [
        repr(one) for piece in pieces for one in (piece.samples() if isinstance(piece, Readings) else [piece])
    ]


def block_of(values, status, times):
    return ValueBlock(
        np.arange(len(values), dtype=np.uint32), np.array(values), np.array(status, np.uint32), times
    )


def one_by_one(changes):
    return flat(
        sample(tag, change) for node, change in changes if not is_waiting(change) for tag in TAGS[node]
    )


@settings(max_examples=300, deadline=None)
@given(st.lists(CHANGES, max_size=12))
def test_pieces_say_what_their_samples_say(changes):
    nodes, values = [node for node, _ in changes], [change for _, change in changes]
    assert flat(LoopRows(TAGS).pieces(nodes, values)) == one_by_one(changes)


@settings(max_examples=300, deadline=None)
@given(
    st.lists(
        st.tuples(
            st.sampled_from([*TAGS]),
            st.sampled_from([1.0, 2.0, math.nan]),
            st.sampled_from([0, 0, 0, 0x80000000, ua.StatusCodes.BadWaitingForInitialData]),
        ),
        min_size=1,
        max_size=12,
    ),
    STEPS,
)
def test_a_block_says_what_its_values_say(items, steps):
    nodes, values, status = zip(*items, strict=True)
    times = np.cumsum(steps)[: len(nodes)]
    block = ValueBlock(
        np.arange(len(nodes), dtype=np.uint32), np.array(values), np.array(status, np.uint32), times
    )
    changes = [
        (node, NodeValue(value, code, time))
        for node, value, code, time in zip(nodes, values, status, times.tolist(), strict=True)
    ]
    pieces = [*LoopRows(TAGS).pieces(nodes, block)]
    assert flat(pieces) == one_by_one(changes)
    same = [*LoopRows(TAGS).pieces(nodes, [change for _, change in changes])]
    assert list(map(repr, pieces)) == list(map(repr, same))


def test_values_of_a_loop_with_one_time_are_one_piece_with_the_same_tags_again():
    rows = LoopRows(
        {f"{loop}.{role}": [LoopRole(loop, role)] for loop in "XY" for role in ("pv", "op", "sp")}
    )
    nodes = ["X.pv", "X.op", "X.sp", "Y.pv", "Y.sp", "Y.op"]

    def block(time):
        return ValueBlock(
            np.arange(6, dtype=np.uint32), np.arange(6.0), np.zeros(6, np.uint32), np.full(6, time)
        )

    whole, some, alone = rows.pieces(nodes, block(9.0))
    assert (whole.values.tolist(), some.values.tolist(), alone.value) == ([0.0, 1.0, 2.0], [3.0, 4.0], 5.0)
    again, some_again, _ = rows.pieces(nodes, [NodeValue(value, 0, 10.0) for value in range(6)])
    assert again.tags is whole.tags
    assert some_again.tags is some.tags
    assert [tag.role for tag in some.tags] == ["pv", "sp"]
