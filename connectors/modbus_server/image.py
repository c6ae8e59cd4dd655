"""What clients read and write: the register map filled with what was published, and the orders that wait."""

from __future__ import annotations

import asyncio
import contextlib
import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from connectors.base import Action, JsonValue, Order, Publication, Quality
from connectors.modbus.codec import Order as ByteOrder
from connectors.modbus.codec import encode
from connectors.modbus_server import register_map as at

FUNCTION, ADDRESS, VALUE, BUSY = 1, 2, 3, 6
"""Exception codes (Modbus application protocol 1.1b3, 7): illegal function, data address, data value; and
that a former order still waits."""


class IllegalError(Exception):
    """A request that the server answers with an exception."""

    def __init__(self, code: int) -> None:
        super().__init__(f"Modbus exception {code}")
        self.code = code


@dataclass(frozen=True, slots=True)
class Asked:
    """An order that a client wrote."""

    order: Order
    place: tuple[str, int]
    """Table and address that reads 0 again when it is taken."""


class Image:
    """The tables of the server. Addresses are those on the wire."""

    def __init__(
        self,
        loops: Sequence[str],
        byte_order: ByteOrder = "ABCD",
        *,
        takes_orders: bool = False,
        clock: Callable[[], float] = time.time,
    ) -> None:
        """Make it, with nothing known of any loop.

        Args:
            loops: In the order of their blocks.
            byte_order: Of numbers of 32 bit.
            takes_orders: Whether anything may be written.
            clock: Gives the time, s UTC.
        """
        self._waits = asyncio.Event()
        self._loops = {loop: index for index, loop in enumerate(loops)}
        self._byte_order: ByteOrder = byte_order
        self._takes_orders = takes_orders
        self._clock = clock
        self._asked: dict[tuple[str, int], Asked] = {}
        self._registers = [0] * at.block(len(loops))
        self._registers[:5] = [at.VERSION, 0, len(loops), at.BLOCK, at.block(0)]
        for loop in loops:
            self._write_numbers(loop, {})
            self._registers[self._at(loop, at.MINUTES)] = at.SHELVING

    def beat(self) -> None:
        """Let the heartbeat rise; to be called every second."""
        self._registers[at.HEARTBEAT] = (self._registers[at.HEARTBEAT] + 1) % 0x10000
        self._put(at.TIME, self._clock())

    def show(self, publication: Publication) -> None:
        """Show a state of a loop that is on the map; anything else is left out."""
        if publication.kind != "state" or publication.subject not in self._loops:
            return
        loop, fields = publication.subject, publication.fields
        state = _number_of(fields.get("state"), at.STATES)
        health = fields.get("health")
        ne107 = int(health) if isinstance(health, int | float) and 0 <= health <= 4 else 0
        status = 0x8000 | int(bool(fields.get("active")))
        status |= {2: 0b10, 3: 0b10000, 4: 0b100, 5: 0b1000}.get(state, 0)
        status |= 1 << (7 + ne107) if ne107 else 0
        words = {
            at.STATUS: status,
            at.STATE: state,
            at.NE107: ne107,
            at.VERDICT: _number_of(fields.get("verdict"), at.VERDICTS),
            at.PRIORITY: _number_of(fields.get("priority"), at.PRIORITIES),
        }
        for offset, word in words.items():
            self._registers[self._at(loop, offset)] = word
        self._write_numbers(loop, dict(fields))
        active = (self._registers[self._at(each, at.STATUS)] & 1 for each in self._loops)
        self._registers[at.ACTIVE_LOOPS] = sum(active)

    async def order_within(self, seconds: float) -> None:
        """Return when an order waits, or after so many seconds."""
        with contextlib.suppress(TimeoutError):
            async with asyncio.timeout(seconds):
                await self._waits.wait()

    def oldest(self) -> Asked | None:
        """Return the order that waits longest."""
        return next(iter(self._asked.values()), None)

    def taken(self, asked: Asked) -> None:
        """Let the place of an order read 0 again."""
        self._asked.pop(asked.place, None)
        if not self._asked:
            self._waits.clear()

    def read_registers(self, address: int, count: int) -> list[int]:
        """Return registers; raises IllegalError."""
        _check(address, count, len(self._registers))
        return [
            self._waiting(place) if place % at.BLOCK == at.ORDER else self._registers[place]
            for place in range(address, address + count)
        ]

    def read_discrete_inputs(self, address: int, count: int) -> list[bool]:
        """Return the bits of the status words; raises IllegalError."""
        _check(address, count, at.BITS * len(self._loops))
        return [
            bool(self._registers[at.block(place // at.BITS) + at.STATUS] >> place % at.BITS & 1)
            for place in range(address, address + count)
        ]

    def read_coils(self, address: int, count: int) -> list[bool]:
        """Return which acknowledgements wait; raises IllegalError."""
        _check(address, count, len(self._loops))
        return [("coil", place) in self._asked for place in range(address, address + count)]

    def write_coils(self, address: int, values: Sequence[bool], by: str) -> None:
        """Take acknowledgements, all or none; raises IllegalError."""
        self._check_right()
        _check(address, len(values), len(self._loops))
        for place, value in enumerate(values, address):
            if value:
                self._ask("acknowledge", place, ("coil", place), by)

    def write_registers(self, address: int, values: Sequence[int], by: str) -> None:
        """Take orders and times of shelving, all or none; raises IllegalError."""
        self._check_right()
        _check(address, len(values), len(self._registers))
        written = dict(enumerate(values, address))
        if any(place < at.BLOCK or place % at.BLOCK not in (at.ORDER, at.MINUTES) for place in written):
            raise IllegalError(ADDRESS)
        for place, value in written.items():
            is_order = place % at.BLOCK == at.ORDER
            if not (value in {0, *at.ORDERS} if is_order else value > 0):
                raise IllegalError(VALUE)
            if is_order and value and self._waiting(place) not in (0, value):
                raise IllegalError(BUSY)
        # the time of shelving comes after the order but counts for it
        for place, value in sorted(written.items(), key=lambda item: item[0] % at.BLOCK, reverse=True):
            if place % at.BLOCK == at.MINUTES:
                self._registers[place] = value
            elif value:
                self._ask(at.ORDERS[value], place // at.BLOCK - 1, ("register", place), by)

    def _check_right(self) -> None:
        if not self._takes_orders:
            raise IllegalError(FUNCTION)

    def _ask(self, action: Action, index: int, place: tuple[str, int], by: str) -> None:
        """Let an order wait, unless one from the same place does."""
        if place in self._asked:
            return
        loop = list(self._loops)[index]
        minutes = self._registers[self._at(loop, at.MINUTES)]
        until = self._clock() + 60 * minutes if action == "shelve" else None
        self._asked[place] = Asked(Order(loop, action, by, until), place)
        self._waits.set()

    def _waiting(self, place: int) -> int:
        """Return the number of the order that waits in a register, 0 if none does."""
        asked = self._asked.get(("register", place))
        return next((n for n, action in at.ORDERS.items() if asked and asked.order.action == action), 0)

    def _write_numbers(self, loop: str, fields: dict[str, JsonValue]) -> None:
        found = {name: _float(fields.get(name)) for name in at.NUMBERS}
        quality = Quality.GOOD if fields.get("verdict") == "stiction" else Quality.UNCERTAIN
        if all(map(math.isnan, found.values())):
            quality = Quality.BAD
        self._registers[self._at(loop, at.QUALITY)] = quality
        for name, offset in at.NUMBERS.items():
            first = self._at(loop, offset)
            self._registers[first : first + 2] = encode(found[name], "float32", self._byte_order)
        for name, offset in (("time", at.TOLD), ("until", at.UNTIL)):
            self._put(self._at(loop, offset), _float(fields.get(name)))

    def _put(self, address: int, seconds: float) -> None:
        known = 0.0 if math.isnan(seconds) else seconds
        self._registers[address : address + 2] = encode(known, "uint32", self._byte_order)

    def _at(self, loop: str, offset: int) -> int:
        return at.block(self._loops[loop]) + offset


def _check(address: int, count: int, size: int) -> None:
    if address + count > size:
        raise IllegalError(ADDRESS)


def _number_of(word: JsonValue, words: Sequence[str]) -> int:
    return words.index(word) if isinstance(word, str) and word in words else 0


def _float(value: JsonValue) -> float:
    return float(value) if isinstance(value, int | float) and not isinstance(value, bool) else math.nan
