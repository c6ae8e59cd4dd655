"""Numbers in 16-bit registers: every type, byte order, scale and offset.

Modbus itself knows only 16-bit registers, high byte first; how a device lays larger numbers over them is its
maker's choice. The four orders cover what is sold: ``ABCD`` names the bytes of a 32-bit number in the order
they arrive, A the most significant.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Sequence
from typing import Literal

RegisterType = Literal["int16", "uint16", "int32", "uint32", "int64", "uint64", "float32", "float64"]
Order = Literal["ABCD", "CDAB", "BADC", "DCBA"]

FORMATS = {
    "int16": "h",
    "uint16": "H",
    "int32": "i",
    "uint32": "I",
    "int64": "q",
    "uint64": "Q",
    "float32": "f",
    "float64": "d",
}
"""Character of each type, as struct and numpy have it."""
LAST_WORD_FIRST, LOW_BYTE_FIRST = ("CDAB", "DCBA"), ("BADC", "DCBA")
"""Orders whose least significant register comes first, and those whose registers begin with the low byte."""

_NUMBERS = {type_: struct.Struct(f">{form}") for type_, form in FORMATS.items()}
_COUNTS = {type_: number.size // 2 for type_, number in _NUMBERS.items()}
_WORDS = {(mark, count): struct.Struct(f"{mark}{count}H") for mark in "><" for count in (1, 2, 4)}
"""Registers as bytes: by the order of the two bytes of each, and how many there are."""


def register_count(type_: RegisterType) -> int:
    """Return how many registers a number of this type takes."""
    return _COUNTS[type_]


def decode(registers: Sequence[int], type_: RegisterType, order: Order = "ABCD") -> float:
    """Return the number in ``registers``: ``register_count(type_)`` of them, 0 to 65535 each.

    A 64-bit integer beyond 2**53 loses its last digits, as samples are floats.
    """
    words = registers[::-1] if order in LAST_WORD_FIRST else registers
    mark = "<" if order in LOW_BYTE_FIRST else ">"
    return float(_NUMBERS[type_].unpack(_WORDS[mark, _COUNTS[type_]].pack(*words))[0])


def encode(value: float, type_: RegisterType, order: Order = "ABCD") -> list[int]:
    """Return the registers that hold ``value``.

    An integer type rounds, and stops at the ends of its range instead of wrapping. It has no NaN: there the
    value that SunSpec calls "not implemented" stands for it (int16 0x8000, uint16 0xFFFF, and so on).
    """
    number = value if type_.startswith("float") else _integer(value, type_)
    try:
        raw = struct.pack(f">{FORMATS[type_]}", number)
    except OverflowError:  # too large for float32
        raw = struct.pack(f">{FORMATS[type_]}", math.copysign(math.inf, value))
    words = [raw[i : i + 2] for i in range(0, len(raw), 2)]
    return [int.from_bytes(word, "big") for word in _reordered(words, order)]


def scaled(raw: float, scale: float, offset: float) -> float:
    """Return the value in engineering units."""
    return raw * scale + offset


def unscaled(value: float, scale: float, offset: float) -> float:
    """Return what to store so that ``scaled`` gives ``value`` again."""
    return (value - offset) / scale


def _reordered(words: list[bytes], order: Order) -> list[bytes]:
    """Turn device order into big-endian order, or back: each order is its own inverse."""
    if order in LOW_BYTE_FIRST:
        words = [word[::-1] for word in words]
    return words[::-1] if order in LAST_WORD_FIRST else words


def _integer(value: float, type_: RegisterType) -> int:
    bits = 16 * register_count(type_)
    low, high = (0, 2**bits - 1) if type_.startswith("u") else (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1)
    if math.isnan(value):
        return high if type_.startswith("u") else low
    return round(min(max(value, low), high)) if math.isfinite(value) else (high if value > 0 else low)
