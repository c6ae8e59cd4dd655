"""All numbers of an answer at once, by numpy: a call for each type and byte order, not for each value."""

from __future__ import annotations

import struct
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from connectors.modbus.blocks import Block
from connectors.modbus.codec import FORMATS, LAST_WORD_FIRST, LOW_BYTE_FIRST, register_count
from connectors.modbus.options import ModbusTag


class _Alike(NamedTuple):
    """Tags of one type and byte order."""

    columns: NDArray[np.intp]
    """Where their values go, shape (m,)."""
    registers: NDArray[np.intp]
    """Which registers each takes, the most significant first, shape (m, registers)."""
    dtype: str
    swaps: bool
    """Whether the two bytes of each register come in the other order."""


class WholeAnswer:
    """How the values of many tags lie in one answer."""

    def __init__(self, first: int, blocks: Sequence[Block]) -> None:
        """Plan it.

        Args:
            first: Address of the answer's first register or bit, on the wire.
            blocks: Whose tags it holds; their values come in this order.
        """
        tags = [
            (tag, tag.address - block.address_base - first) for block in blocks for tag in block.tags.values()
        ]
        self._bits = np.array([place for _, place in tags]) if tags[0][0].is_bit else None
        self._scale = np.array([1.0 if tag.is_bit else tag.scale for tag, _ in tags])
        self._offset = np.array([0.0 if tag.is_bit else tag.offset for tag, _ in tags])
        alike: dict[tuple[str, str], list[int]] = {}
        for column, (tag, _) in enumerate(tags):
            alike.setdefault((tag.type, tag.order), []).append(column)
        self._alike = [] if self._bits is not None else [_of(tags, columns) for columns in alike.values()]

    def values(self, answer: Sequence[int]) -> NDArray[np.float64]:
        """Return the values in engineering units, shape (tags,), from the registers or bits of the answer."""
        if self._bits is not None:
            bits: NDArray[np.float64] = np.asarray(answer, dtype=np.float64)[self._bits]
            return bits
        words = np.frombuffer(struct.pack(f">{len(answer)}H", *answer), dtype=">u2")
        swapped = None
        values: NDArray[np.float64] = np.empty(len(self._scale))
        with np.errstate(invalid="ignore", over="ignore"):  # NaN of a device, or beyond all numbers: a gap
            for each in self._alike:
                if each.swaps and swapped is None:
                    swapped = words.byteswap()
                numbers = (swapped if swapped is not None and each.swaps else words)[each.registers]
                values[each.columns] = numbers.view(each.dtype)[:, 0]
            values *= self._scale
            values += self._offset
        return values


def _of(tags: Sequence[tuple[ModbusTag, int]], columns: Sequence[int]) -> _Alike:
    """Return the plan of the tags of these columns, all of one type and byte order."""
    tag = tags[columns[0]][0]
    within = np.arange(register_count(tag.type))
    if tag.order in LAST_WORD_FIRST:
        within = within[::-1]
    places = np.array([tags[column][1] for column in columns])
    return _Alike(
        np.array(columns), places[:, None] + within, f">{FORMATS[tag.type]}", tag.order in LOW_BYTE_FIRST
    )
