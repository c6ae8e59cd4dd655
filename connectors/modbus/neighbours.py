"""Blocks of neighbouring loops in one request: a round trip for many loops, not one for each.

Only loops whose values all lie in one block take part, so that they still come from one instant. A device
that does not give the registers between, or so many at once, gets a request for each block from then on.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from connectors.modbus.block_reader import UNREACHABLE, BlockReader
from connectors.modbus.blocks import MOST_BITS, MOST_REGISTERS, Block
from connectors.modbus.client import DeviceError, SilentBlockError
from connectors.modbus.parking import Parking

WIDEST_GAP = 16
"""Registers between two blocks that are read and discarded rather than requested apart."""
MOST_GAP_BITS = 16 * WIDEST_GAP


@dataclass(frozen=True, slots=True)
class Span:
    """One request for blocks of several loops."""

    whole: Block
    """The request; it has no tags of its own."""
    parts: tuple[Block, ...]

    def part(self, answer: Sequence[int], block: Block) -> Sequence[int]:
        """Return what a block has of the answer to the whole."""
        first = block.address - self.whole.address
        return answer[first : first + block.count]


def spans(blocks: Sequence[Block]) -> list[Span]:
    """Return the fewest requests for blocks that may be read together, in the order of their addresses."""
    found: list[list[Block]] = []
    for block in sorted(blocks, key=lambda each: (each.table, each.address)):
        if found and _near(found[-1], block):
            found[-1].append(block)
        else:
            found.append([block])
    return [Span(_whole(parts), tuple(parts)) for parts in found]


class NeighbourReader:
    """Reads blocks, those of one span in one request a round."""

    def __init__(self, reader: BlockReader, parking: Parking, together: dict[int, Span]) -> None:
        """Make it.

        Args:
            reader: Reads one block.
            parking: Of the device.
            together: Block, by its ``id``, -> its span; those that the device does not allow are taken out.
        """
        self._reader = reader
        self._parking = parking
        self._span_of = together
        self._answers: dict[int, Sequence[int] | DeviceError] = {}

    def begin_round(self) -> None:
        """Forget the answers of the former round."""
        self._answers.clear()

    async def read(self, block: Block) -> Sequence[int]:
        """Return its registers or bits; raises DeviceError, and ConnectionLostError where all are silent."""
        span = self._span_of.get(id(block))
        if span is None:
            return await self._reader.read(block)
        if id(span) not in self._answers and not await self._read_whole(span):
            return await self._reader.read(block)
        answer = self._answers[id(span)]
        if isinstance(answer, DeviceError):
            raise answer
        return span.part(answer, block)

    async def read_together(self, span: Span) -> Sequence[int] | None:
        """Return the answer to a span; None where its blocks are to be read one by one, for their reasons."""
        if id(span.parts[0]) not in self._span_of or not await self._read_whole(span):
            return None
        answer = self._answers[id(span)]
        return None if isinstance(answer, DeviceError) else answer

    async def _read_whole(self, span: Span) -> bool:
        """Read a span; return whether it stays one."""
        try:
            self._answers[id(span)] = await self._reader.read(span.whole)
        except SilentBlockError:
            self._parking.release(span.whole)  # perhaps one of its parts is to blame
        except DeviceError as error:
            if error.code in UNREACHABLE:  # a word about the unit, not about these registers
                self._answers[id(span)] = error
                return True
        else:
            return True
        for part in span.parts:
            self._span_of.pop(id(part), None)
        return False


def span_of_each(together: Sequence[Span]) -> dict[int, Span]:
    """Return block, by its ``id``, -> span, for blocks that have neighbours."""
    return {id(part): span for span in together if len(span.parts) > 1 for part in span.parts}


def _near(parts: Sequence[Block], block: Block) -> bool:
    first, last = parts[0], max(parts, key=lambda each: each.address + each.count)
    bits = block.table in ("coil", "discrete")
    gap = block.address - (last.address + last.count)
    end = max(last.address + last.count, block.address + block.count)
    most, widest = (MOST_BITS, MOST_GAP_BITS) if bits else (MOST_REGISTERS, WIDEST_GAP)
    return first.table == block.table and gap <= widest and end - first.address <= most


def _whole(parts: Sequence[Block]) -> Block:
    first = parts[0].address
    end = max(each.address + each.count for each in parts)
    return Block(parts[0].table, first, end - first, {}, parts[0].address_base)
