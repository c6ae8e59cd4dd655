"""Polls loops: those of one request together, over as many connections as the device has for us."""

from __future__ import annotations

import asyncio
import math
import time
from collections import deque
from collections.abc import AsyncGenerator, Mapping, Sequence
from itertools import accumulate

import numpy as np
from numpy.typing import NDArray

from connectors.base import LoopRole, Sample
from connectors.modbus.block_reader import BlockReader
from connectors.modbus.blocks import Block, plan
from connectors.modbus.client import ILLEGAL_ADDRESS, DeviceError, ModbusClient
from connectors.modbus.neighbours import NeighbourReader, Span, span_of_each, spans
from connectors.modbus.options import ModbusTag
from connectors.modbus.parking import Parking
from connectors.modbus.whole import WholeAnswer
from connectors.readings import Readings


class LoopPoller:
    """Reads one loop; remembers the source time it saw last, and which blocks the device does not allow."""

    def __init__(self, loop: str, blocks: list[Block]) -> None:
        self.blocks = blocks
        self.tags = {role: LoopRole(loop, role) for block in blocks for role in block.tags}
        """Role -> tag, in the order of the values of its blocks."""
        self.has_time = any("time" in block.tags for block in blocks)
        """Whether the source's own time is read with the values."""
        self._last_time = math.nan

    def is_new(self, source_time: float) -> bool:
        """Return whether the source's time, s UTC, is there and another one than the last time."""
        if math.isnan(source_time) or source_time == self._last_time:
            return False
        self._last_time = source_time
        return True

    async def poll(self, reader: NeighbourReader) -> list[Sample]:
        """Return one sample for each tag; none where the source's own time says that nothing is new."""
        values: dict[str, float] = {}
        refused: dict[str, DeviceError] = {}
        for block in list(self.blocks):
            try:
                values |= block.values(await reader.read(block))
            except DeviceError as error:
                refused |= dict.fromkeys(block.tags, error)
                if error.code == ILLEGAL_ADDRESS and len(block.tags) > 1:
                    self.blocks = [b for b in self.blocks if b is not block] + block.split()
        arrival = time.time()
        source_time = values.pop("time", math.nan)
        if self.has_time and "time" not in refused:
            if not self.is_new(source_time):
                return []
            arrival = source_time
        refused.pop("time", None)
        return [Sample.measured(self.tags[role], arrival, value) for role, value in values.items()] + [
            Sample.missing(self.tags[role], arrival, error.code, str(error))
            for role, error in refused.items()
        ]


class _OwnTime:
    """A loop whose own time is among the values of an answer."""

    def __init__(self, poller: LoopPoller, first: int) -> None:
        """Make it; its values begin at ``first``."""
        roles = list(poller.tags)
        self._poller = poller
        self._time = first + roles.index("time")
        self._columns = np.array([first + k for k, role in enumerate(roles) if role != "time"], np.intp)
        self._tags = tuple(tag for role, tag in poller.tags.items() if role != "time")

    def pieces(self, values: NDArray[np.float64]) -> Sequence[Sample | Readings]:
        """Return what is new of the loop in the values of an answer, (tags,)."""
        source_time = float(values[self._time])
        if not self._poller.is_new(source_time):
            return ()
        found = Readings(self._tags, source_time, values[self._columns])
        return (found,) if math.isfinite(source_time) else found.samples()


class PolledTogether:
    """Loops that are read in one request, as long as the device allows it."""

    def __init__(self, pollers: Sequence[LoopPoller], span: Span | None) -> None:
        """Make it; ``span`` is None where each loop has requests of its own."""
        self._pollers = pollers
        self._span = span
        if span is None:
            return
        self._whole = WholeAnswer(span.whole.address, [each.blocks[0] for each in pollers])
        firsts = accumulate((len(each.tags) for each in pollers), initial=0)
        placed = list(zip(firsts, pollers, strict=False))  # the last sum is that of all
        self._own_time = [_OwnTime(each, first) for first, each in placed if each.has_time]
        without = [(first, each) for first, each in placed if not each.has_time]
        self._tags = tuple(tag for _, each in without for tag in each.tags.values())
        self._columns = np.array(
            [first + k for first, each in without for k in range(len(each.tags))], np.intp
        )

    async def poll(self, lane: NeighbourReader) -> Sequence[Sample | Readings]:
        """Return what is new, in one piece where it comes in one; raises ConnectionLostError."""
        if self._span is not None:
            answer = await lane.read_together(self._span)
            if answer is not None:
                return self._pieces(self._whole.values(answer))
        return [sample for poller in self._pollers for sample in await poller.poll(lane)]

    def _pieces(self, values: NDArray[np.float64]) -> list[Sample | Readings]:
        if not self._own_time:
            return [Readings(self._tags, time.time(), values)]
        together = [Readings(self._tags, time.time(), values[self._columns])] if self._tags else []
        return [*together, *(piece for each in self._own_time for piece in each.pieces(values))]


class Rounds:
    """Reads all loops of a device again and again."""

    def __init__(
        self,
        clients: Sequence[ModbusClient],
        loops: Mapping[str, Mapping[str, ModbusTag]],
        address_base: int,
        parking: Parking,
    ) -> None:
        """Plan it.

        Args:
            clients: Connections to the device, one as often as requests may be under way on it.
            loops: Loop -> role -> tag; those without tags are left out.
            address_base: Number of a table's first register.
            parking: Of the device.
        """
        pollers = [LoopPoller(name, plan(tags, address_base)) for name, tags in loops.items() if tags]
        blocks = [block for each in pollers for block in each.blocks]
        alone = [each.blocks[0] for each in pollers if len(each.blocks) == 1]
        together = span_of_each(spans(alone))
        self._groups = _groups(pollers, together)
        self._lanes = [
            NeighbourReader(BlockReader(client, blocks, parking), parking, together) for client in clients
        ]

    async def read(self) -> AsyncGenerator[Sample | Readings]:
        """Yield the values of every loop once, each request's as it comes; raises ConnectionLostError."""
        for lane in self._lanes:
            lane.begin_round()
        waiting, found, came = deque(self._groups), deque[Sample | Readings](), asyncio.Event()
        reads = [asyncio.create_task(_poll(waiting, lane, found, came), name="poll") for lane in self._lanes]
        try:
            ended: list[asyncio.Task[None]] = []
            while len(ended) < len(reads):
                await came.wait()
                came.clear()
                ended = [each for each in reads if each.done()]
                for each in ended:
                    each.result()
                while found:
                    yield found.popleft()
        finally:
            for each in reads:
                each.cancel()
            await asyncio.gather(*reads, return_exceptions=True)


async def _poll(
    waiting: deque[PolledTogether],
    lane: NeighbourReader,
    found: deque[Sample | Readings],
    came: asyncio.Event,
) -> None:
    """Read what waits until nothing does; each answer goes to ``found`` at once."""
    try:
        while waiting:
            found.extend(await waiting.popleft().poll(lane))
            came.set()
    finally:
        came.set()


def _groups(pollers: Sequence[LoopPoller], together: Mapping[int, Span]) -> list[PolledTogether]:
    """Return the loops of each request, in the order of the first of them."""
    groups: dict[int, tuple[list[LoopPoller], Span | None]] = {}
    for poller in pollers:
        span = together.get(id(poller.blocks[0])) if len(poller.blocks) == 1 else None
        groups.setdefault(id(poller if span is None else span), ([], span))[0].append(poller)
    return [PolledTogether(*each) for each in groups.values()]
