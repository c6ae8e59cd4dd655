"""The variables of a MAT-file up to version 7: numbers and structures; text, objects and tables are left out.

Read here and not by ``scipy.io``, which ends the process on damaged files and on deep structures.
Source: The MathWorks, MAT-File Format (2024), chapter 1.
"""

from __future__ import annotations

import math
import struct
import zlib
from dataclasses import dataclass
from itertools import count
from typing import TYPE_CHECKING, Union

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterator

    from connectors.exports.tables.sheet import FloatArray

Value = Union["FloatArray", dict[str, "Value"], list["Value"], None]
"""A number or array without dimensions of one, a structure, an array of structures or cells; None: other."""

HEADER, ENDIAN, VERSION = 128, slice(126, 128), slice(124, 126)
MATRIX, COMPRESSED = 14, 15
"""Kinds of elements."""
CELL, STRUCTURE = 1, 2
"""Classes of arrays."""
NUMERIC = range(6, 16)
STORED = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 9: "f8", 12: "i8", 13: "u8"}
"""Kind of an element -> its numbers."""
HDF5 = 2
"""Version over 256 of a file that is HDF5 inside (``-v7.3``)."""
DEEPEST = 20
"""Structures within structures."""
MOST_VALUES = 1_000_000
"""Variables and fields of a file: each takes memory, however little of the file it is."""
MOST_DIMENSIONS = 32
"""Of an array; numpy has no more."""
DAMAGED = "it is cut off or damaged"


class MatFileError(ValueError):
    """A MAT-file that cannot be read, in words."""


@dataclass(frozen=True, slots=True)
class _Reader:
    data: bytes
    order: str
    """``<`` or ``>``."""
    read: Iterator[int]
    """Counts the values of a file."""

    def element(self, at: int, end: int) -> tuple[int, int, int, int]:
        """Return kind, begin and end of the content, and where the next element begins."""
        if at + 8 > end:
            raise MatFileError(DAMAGED)
        kind, length = struct.unpack_from(f"{self.order}II", self.data, at)
        begin, following = at + 8, at + 8 + length + (-length) % 8
        if kind >> 16:  # a small one, with its content within the tag
            kind, length, begin, following = kind & 0xFFFF, kind >> 16, at + 4, at + 8
        if begin + length > end:
            raise MatFileError(DAMAGED)
        return kind, begin, begin + length, following

    def numbers(self, at: int, end: int) -> tuple[FloatArray, int]:
        """Return the numbers of an element, (n,), and where the next one begins."""
        kind, begin, stop, following = self.element(at, end)
        dtype = np.dtype(f"{self.order}{STORED.get(kind, 'u1')}")
        whole = (stop - begin) // dtype.itemsize
        return np.frombuffer(self.data, dtype, whole, begin).astype(np.float64), following

    def matrix(self, at: int, end: int, depth: int) -> tuple[str, Value]:
        """Return name and value of a variable or of a field, whose name is empty."""
        if depth > DEEPEST:
            raise MatFileError(f"it has more than {DEEPEST} structures within each other")
        if next(self.read) >= MOST_VALUES:
            raise MatFileError(f"it has more than {MOST_VALUES} variables and fields")
        if at == end:
            return "", None
        _, flags, stop, at = self.element(at, end)
        if stop < flags + 4:
            raise MatFileError(DAMAGED)
        kind = struct.unpack_from(f"{self.order}I", self.data, flags)[0] & 0xFF
        shape, at = self.numbers(at, end)
        sizes = [int(each) for each in shape]
        if not 0 < len(sizes) <= MOST_DIMENSIONS or min(sizes) < 0:
            raise MatFileError(DAMAGED)
        _, begin, stop, at = self.element(at, end)
        name = self.data[begin:stop].decode("latin-1")
        if kind in NUMERIC:
            values, _ = self.numbers(at, end)
            if len(values) != math.prod(sizes):
                raise MatFileError(DAMAGED)
            return name, values.reshape(sizes, order="F").squeeze()
        if kind == STRUCTURE:
            return name, self._structures(at, end, math.prod(sizes), depth)
        if kind == CELL:
            return name, self._fields(at, end, math.prod(sizes), depth)[0]
        return name, None

    def _structures(self, at: int, end: int, number: int, depth: int) -> Value:
        length, at = self.numbers(at, end)
        _, begin, stop, at = self.element(at, end)
        width = int(length[0]) if len(length) else 0
        if width <= 0 or begin == stop:
            return {}
        words = [self.data[k : k + width] for k in range(begin, stop, width)]
        names = [word.split(b"\0")[0].decode("latin-1") for word in words]
        found: list[Value] = []
        for _ in range(number):
            fields, at = self._fields(at, end, len(names), depth)
            found.append(dict(zip(names, fields, strict=True)))
        return found[0] if number == 1 else found

    def _fields(self, at: int, end: int, number: int, depth: int) -> tuple[list[Value], int]:
        found: list[Value] = []
        for _ in range(number):
            _, begin, stop, at = self.element(at, end)
            found.append(self.matrix(begin, stop, depth + 1)[1])
        return found, at


def variables(data: bytes, most: int) -> dict[str, Value]:
    """Return the variables of a file by their names.

    Args:
        data: The file.
        most: Bytes of all variables together, unpacked.

    Raises:
        MatFileError: It is damaged, of version 7.3, or larger unpacked.
    """
    order = {b"IM": "<", b"MI": ">"}.get(data[ENDIAN])
    if order is None:
        raise MatFileError("its header is cut off or damaged")
    if struct.unpack(f"{order}H", data[VERSION])[0] >> 8 == HDF5:
        raise MatFileError("it is of version 7.3: save it with -v7, or export it as CSV")
    file, at, found = _Reader(data, order, count()), HEADER, dict[str, Value]()
    while at < len(data):
        kind, begin, stop, padded = file.element(at, len(data))
        reader = file
        at = stop if kind == COMPRESSED else padded  # what is packed is not padded
        if kind == COMPRESSED:
            try:
                unpacked = zlib.decompressobj().decompress(data[begin:stop], most + 1)
            except zlib.error as error:
                raise MatFileError(f"it is damaged: {error}") from error
            most -= len(unpacked)
            if most < 0:
                raise MatFileError("it is too large when unpacked: split it by loop")
            reader = _Reader(unpacked, order, file.read)
            kind, begin, stop, _ = reader.element(0, len(reader.data))
        if kind == MATRIX:
            name, value = reader.matrix(begin, stop, 0)
            found[name] = value
    return found
