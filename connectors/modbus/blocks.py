"""Which registers to request together, so that all values of a loop come from one instant."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from connectors.modbus.codec import decode, scaled
from connectors.modbus.options import ModbusTag, Table

MOST_REGISTERS = 125
MOST_BITS = 2000
"""Limits of one request (Modbus application protocol 1.1b3, 6.1 to 6.4)."""


@dataclass(frozen=True, slots=True)
class Block:
    """One request and the tags it answers."""

    table: Table
    address: int
    """As on the wire, from 0."""
    count: int
    """Registers, or bits."""
    tags: Mapping[str, ModbusTag]
    """Role -> tag."""
    address_base: int
    _places: tuple[tuple[str, ModbusTag, int, int], ...] = field(init=False, repr=False, compare=False)
    """Role, tag, and from where to where its registers or bit stand in the answer."""

    def __post_init__(self) -> None:
        first = self.address + self.address_base
        places = [
            (r, tag, tag.address - first, tag.address - first + tag.size) for r, tag in self.tags.items()
        ]
        object.__setattr__(self, "_places", tuple(places))

    def __str__(self) -> str:
        """Return what is requested, with addresses as in the configuration, e.g. ``input 100 to 109``."""
        first = self.address + self.address_base
        return f"{self.table} {first}" + (f" to {first + self.count - 1}" if self.count > 1 else "")

    def values(self, answer: Sequence[int]) -> dict[str, float]:
        """Return role -> value in engineering units from the ``count`` registers or bits of the answer."""
        return {role: _value(tag, answer[begin:end]) for role, tag, begin, end in self._places}

    def split(self) -> list[Block]:
        """Return one block for each tag, for a device where addresses between them cannot be read."""
        return [covering({role: tag}, self.address_base) for role, tag in self.tags.items()]


def _value(tag: ModbusTag, registers: Sequence[int]) -> float:
    """Return the number in its registers, or its bit."""
    if tag.is_bit:
        return float(registers[0])
    return scaled(decode(registers, tag.type, tag.order), tag.scale, tag.offset)


def covering(tags: Mapping[str, ModbusTag], address_base: int) -> Block:
    """Return the block that spans ``tags``, all of one table."""
    first = min(tag.address for tag in tags.values())
    end = max(tag.address + tag.size for tag in tags.values())
    (table,) = {tag.table for tag in tags.values()}
    return Block(table, first - address_base, end - first, tags, address_base)


def plan(tags: Mapping[str, ModbusTag], address_base: int) -> list[Block]:
    """Return the fewest blocks that hold all tags: one, where they are of one table and near enough."""
    blocks: list[Block] = []
    for role, tag in sorted(tags.items(), key=lambda item: (item[1].table, item[1].address)):
        most = MOST_BITS if tag.is_bit else MOST_REGISTERS
        if blocks and blocks[-1].table == tag.table:
            wider = covering({**blocks[-1].tags, role: tag}, address_base)
            if wider.count <= most:
                blocks[-1] = wider
                continue
        blocks.append(covering({role: tag}, address_base))
    return blocks
