"""The usual answer to a publish request, out of its bytes: numbers with their times (OPC UA Part 6, 5.2).

asyncua makes six objects of each value by a general decoder. Here numpy reads values of one layout that stand
side by side, and ``struct`` reads shorter runs; what is not plain is left to asyncua: ``read_response`` then
returns None, and an item of another layout (text, an array, 64-bit integers, no value) goes to its decoder
alone.
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import product
from typing import Generic, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

Other = TypeVar("Other")

_EPOCH = 11_644_473_600
"""s from 1601 to 1970."""
_TICKS, _MICROSECONDS = 10, 1_000_000
"""Ticks in a microsecond, microseconds in a second."""
_EXACT = range(_EPOCH * 10_000_000 - 9 * 10**16, _EPOCH * 10_000_000 + 9 * 10**16)
"""Ticks whose microseconds from 1970 are exact as a float: the years 1685 to 2255."""
_FEW, _MOST = 8, 4096
"""Items that numpy reads at once: fewer are read faster one by one, and no more are looked at in vain."""
_LAST = 2_650_467_743_990_000_000
"""Ticks from which a time is none any more: the end of the year 9999."""
_VALUE, _STATUS, _SOURCE, _SERVER, _SOURCE_PICO, _SERVER_PICO = (1 << bit for bit in range(6))
"""Bits of the mask of a DataValue."""
_BOOLEAN = 1
_KINDS = {_BOOLEAN: "?", 2: "b", 3: "B", 4: "h", 5: "H", 6: "i", 7: "I", 10: "f", 11: "d"}
"""Types of a Variant that are exact as a float -> their letters in ``struct``."""
_NUMPY = {"?": "u1", "b": "i1", "B": "u1", "h": "i2", "H": "u2", "i": "i4", "I": "u4", "q": "i8"} | {
    "f": "f4",
    "d": "f8",
}
"""Letters of ``struct`` in numpy."""
_DATA_CHANGE = 811
"""DataChangeNotification_Encoding_DefaultBinary."""
_HEAD = struct.Struct("<BBH q I I B i BB B")
"""Type of the response, time, handle, result, diagnostics, texts, and a null ExtensionObject."""
_PLAIN_TYPE, _RESPONSE, _NO_TYPE = (1, 0), 829, (0, 0)
"""A node id of four bytes in namespace 0; that of PublishResponse; a null one."""
_INT = struct.Struct("<i")
_NO_ARRAY = -1
"""Length of an array that is null; a lower one is no length."""
_RESULT = struct.Struct("<B I q i")
"""More notifications, sequence number, time of publishing, count of notifications."""
_OBJECT = struct.Struct("<BBH B i")
"""Type and length of an ExtensionObject with a body of bytes."""


class NodeValue(NamedTuple):
    """A value of a node as its server sent it."""

    value: object
    """A number; what else a server may send, None too."""
    status: int
    """OPC UA's code."""
    time: float
    """That of the source, else the server's, s UTC; NaN: neither has one."""


@dataclass(frozen=True, slots=True, eq=False)
class ValueBlock:
    """Values of many nodes, (n,) each."""

    handles: NDArray[np.uint32]
    """Client handles."""
    values: NDArray[np.float64]
    status: NDArray[np.uint32]
    times: NDArray[np.float64]
    """s UTC."""

    def __len__(self) -> int:
        """Return how many."""
        return len(self.handles)

    def first(self, count: int) -> ValueBlock:
        """Return the first of them."""
        return ValueBlock(self.handles[:count], self.values[:count], self.status[:count], self.times[:count])

    def items(self) -> list[tuple[int, NodeValue]]:
        """Return them one by one."""
        columns = (each.tolist() for each in (self.handles, self.values, self.status, self.times))
        return [(handle, NodeValue(*rest)) for handle, *rest in zip(*columns, strict=True)]


@dataclass(frozen=True, slots=True)
class NodeChanges(Generic[Other]):
    """What one notification has, in its order."""

    parts: list[ValueBlock | list[tuple[int, NodeValue] | Other]]
    """Client handles and values, or what another decoder made of an item."""


@dataclass(frozen=True, slots=True)
class PlainResponse(Generic[Other]):
    """A publish response that has nothing but changes of data."""

    subscription: int
    available: list[int]
    """Sequence numbers of messages that may be sent again."""
    more: bool
    sequence: int
    published: int
    """Ticks since 1601."""
    changes: list[NodeChanges[Other]]
    results: list[int]
    """Status of each acknowledgement."""


class _Layout(NamedTuple):
    """Of a MonitoredItemNotification."""

    size: int
    unpack: Callable[[bytes, int], tuple[float, ...]]
    status: int | None
    time: int
    """Where they are among what ``unpack`` gives: handle, mask, kind, value, and so on."""
    kind: np.dtype[np.void]
    """The same for numpy."""


def _layouts() -> Iterator[tuple[bytes, _Layout]]:
    for kind, mask in product(_KINDS, range(1 << 6)):
        if not mask & _VALUE or (mask & _SOURCE_PICO and not mask & _SOURCE):
            continue
        letters, status, source, server = "IBB" + _KINDS[kind], None, None, None
        if mask & _STATUS:
            status = len(letters)
            letters += "I"
        if mask & _SOURCE:
            source = len(letters)
            letters += "q"
        if mask & _SOURCE_PICO:
            letters += "H"
        if mask & _SERVER:
            server = len(letters)
            letters += "q"
        if mask & _SERVER_PICO:
            letters += "H"
        time = source if source is not None else server
        if time is not None:
            laid = struct.Struct("<" + letters)
            fields = np.dtype([(str(k), "<" + _NUMPY[letter]) for k, letter in enumerate(letters)])
            yield bytes((mask, kind)), _Layout(laid.size, laid.unpack_from, status, time, fields)


_LAYOUTS = dict(_layouts())


def read_response(
    data: bytes, other: Callable[[bytes, int], tuple[Other, int]]
) -> PlainResponse[Other] | None:
    """Return the content of a publish response; None where another decoder has to read it.

    Args:
        data: Its bytes, from its type on.
        other: Decodes one item that begins at a place, and returns where it ends.
    """
    try:
        return _response(data, other)
    except (struct.error, IndexError):
        return None  # it ends too early: the other decoder says so in its own words


def _response(data: bytes, other: Callable[[bytes, int], tuple[Other, int]]) -> PlainResponse[Other] | None:
    head = _HEAD.unpack_from(data)
    *_, result, diagnostics, texts, none, no_id, no_body = head
    if head[:3] != (*_PLAIN_TYPE, _RESPONSE) or result or diagnostics or texts > 0 or no_body:
        return None
    if (none, no_id) != _NO_TYPE:
        return None
    (subscription,) = struct.unpack_from("<I", data, _HEAD.size)
    available, at = _numbers(data, _HEAD.size + 4)
    more, sequence, published, count = _RESULT.unpack_from(data, at)
    at += _RESULT.size
    changes = []
    for _ in range(count):
        *kind, encoding, length = _OBJECT.unpack_from(data, at)
        at += _OBJECT.size
        if kind != [*_PLAIN_TYPE, _DATA_CHANGE] or encoding != 1 or not 1 <= length <= len(data) - at:
            return None
        found = read_changes(data[at : at + length], other)
        if found is None:
            return None
        changes.append(found)
        at += length
    results, at = _numbers(data, at)
    (diagnosed,) = _INT.unpack_from(data, at)
    if diagnosed > 0 or not 0 <= published < _LAST:
        return None
    return PlainResponse(subscription, available, bool(more), sequence, published, changes, results)


def read_changes(body: bytes, other: Callable[[bytes, int], tuple[Other, int]]) -> NodeChanges[Other] | None:
    """Return what a DataChangeNotification has; None where it has diagnostics. Raises struct.error."""
    (left,) = _INT.unpack_from(body)
    at = _INT.size
    parts: list[ValueBlock | list[tuple[int, NodeValue] | Other]] = []
    single: list[tuple[int, NodeValue] | Other] = []
    while left > 0:
        block = _block(body, at, left)
        if block is not None:
            part, at = block
            parts += [single, part]
            single = []
            left -= len(part)
            continue
        item, at = _item(body, at) or other(body, at)
        single.append(item)
        left -= 1
    parts.append(single)
    (diagnosed,) = _INT.unpack_from(body, at)
    return None if diagnosed > 0 else NodeChanges(parts)


def _item(body: bytes, at: int) -> tuple[tuple[int, NodeValue], int] | None:
    """Return a plain item and where it ends; None for any other."""
    layout = _LAYOUTS.get(body[at + 4 : at + 6])
    if layout is None:
        return None
    fields = layout.unpack(body, at)
    ticks = int(fields[layout.time])
    if not 0 <= ticks < _LAST:
        return None
    status = 0 if layout.status is None else int(fields[layout.status])
    time = (ticks // _TICKS - _EPOCH * _MICROSECONDS) / _MICROSECONDS
    return (int(fields[0]), NodeValue(fields[3], status, time)), at + layout.size


def _block(body: bytes, at: int, left: int) -> tuple[ValueBlock, int] | None:
    """Return as many items with the layout of the first as there are, and where they end; None if few."""
    key = body[at + 4 : at + 6]
    layout = _LAYOUTS.get(key)
    if layout is None or left < _FEW:
        return None
    last = at + (_FEW - 1) * layout.size + 4
    if body[last : last + 2] != key:
        return None
    count = min(left, _MOST, (len(body) - at) // layout.size)
    table = np.frombuffer(body, layout.kind, count, at)
    ticks = table[str(layout.time)]
    alike = (table["1"] == key[0]) & (table["2"] == key[1]) & (ticks >= _EXACT.start) & (ticks < _EXACT.stop)
    count = count if alike.all() else int(alike.argmin())
    if count < _FEW:
        return None
    table, ticks = table[:count], ticks[:count]
    status = np.zeros(count, np.uint32) if layout.status is None else table[str(layout.status)]
    values = table["3"] if key[1] != _BOOLEAN else table["3"] != 0
    times = (ticks // _TICKS - _EPOCH * _MICROSECONDS) / _MICROSECONDS
    return ValueBlock(table["0"], values.astype(np.float64), status, times), at + count * layout.size


def _numbers(data: bytes, at: int) -> tuple[list[int], int]:
    """Return an array of 32 bits each, and where it ends. Raises struct.error."""
    (count,) = _INT.unpack_from(data, at)
    if count < _NO_ARRAY:
        raise struct.error(f"an array has {count} numbers")
    count = max(count, 0)
    return list(struct.unpack_from(f"<{count}I", data, at + 4)), at + 4 + 4 * count
