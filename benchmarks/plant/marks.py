"""How what reads a plant reports to the benchmark: from one mark of the parent to the next."""

from __future__ import annotations

import asyncio
import math
import time
from collections.abc import Awaitable, Callable, Mapping
from dataclasses import dataclass, field
from multiprocessing.connection import Connection

import numpy as np
from numpy.typing import NDArray

WATCH = "watch"
"""What the parent sends to have the loop watched from now on; True ends that."""
TICK = 0.02
"""How often it is seen whether the loop that reads stands still, s."""
NOTHING = np.zeros(0)


@dataclass(frozen=True)
class Read:
    """What a reader says of the time between two marks."""

    cpu: float
    """Of its process, s."""
    wall: float
    values_of: Mapping[str, int]
    """Of all roles, that reached it, by connection."""
    delays_of: Mapping[str, NDArray[np.float64]]
    """From the sending of a sample to its place in a window, s, by connection."""
    stops: tuple[float, ...]
    """How long the loop that reads stood still, s, the longest ten."""
    lost: int
    looks: int
    """Windows that were judged."""
    fits: int
    """Of these with a fit."""

    @property
    def values(self) -> int:
        """Of all connections."""
        return sum(self.values_of.values())

    @property
    def value_cost(self) -> float:
        """CPU of one value, s; NaN where none came."""
        return self.cpu / self.values if self.values else math.nan

    @property
    def delays(self) -> NDArray[np.float64]:
        """Of all connections, s."""
        return np.concatenate([NOTHING, *self.delays_of.values()])

    @property
    def longest_stop(self) -> float:
        """The longest, s; 0 where it was not watched."""
        return max(self.stops, default=0.0)


class Stops:
    """How long the event loop stood still by its own work; not while others had the core."""

    def __init__(self) -> None:
        self.longest: list[float] = []
        self.wanted = asyncio.Event()
        """Set while it is watched: fifty looks a second are a good part of the CPU of 1000 loops."""

    async def watch(self) -> None:
        """Look every ``TICK`` s while it is wanted."""
        before = time.perf_counter(), time.thread_time()
        while True:
            if not self.wanted.is_set():
                await self.wanted.wait()
                before = time.perf_counter(), time.thread_time()
            await asyncio.sleep(TICK)
            now = time.perf_counter(), time.thread_time()
            late = min(now[0] - before[0] - TICK, now[1] - before[1])
            self.longest = sorted([*self.longest, late])[-10:]
            before = now


@dataclass
class Marks:
    """What a reader measures beside the values that came."""

    stops: Stops = field(default_factory=Stops)
    delays: dict[str, list[float]] = field(default_factory=dict)
    """Filled by who measures them, s, by connection."""
    lost: Callable[[], int] = lambda: 0
    judged: Callable[[], tuple[int, int]] = lambda: (0, 0)
    """Windows, and those with a fit, since the start."""


async def answer(
    says: Connection, count: Callable[[], Awaitable[dict[str, int]]], marks: Marks | None = None
) -> None:
    """Answer each mark of the parent with what happened since the one before; end on an empty one.

    Args:
        says: To the parent.
        count: Returns how many values came, by connection.
        marks: What else is measured; None: nothing.
    """
    marks = marks or Marks()

    async def now() -> tuple[float, float, dict[str, int], int, tuple[int, int]]:
        values = await count()
        return time.process_time(), time.perf_counter(), values, marks.lost(), marks.judged()

    before = await now()
    marked = asyncio.Event()
    asyncio.get_running_loop().add_reader(says.fileno(), marked.set)
    while True:
        await marked.wait()
        marked.clear()
        if not says.poll():
            continue
        wanted = says.recv()
        if wanted is None:
            return
        (marks.stops.wanted.set if wanted == WATCH else marks.stops.wanted.clear)()
        (cpu, wall, values, lost, (looks, fits)), before = before, await now()
        delays = {key: np.array(each) for key, each in marks.delays.items()}
        for each in marks.delays.values():
            each.clear()
        says.send(
            Read(
                before[0] - cpu,
                before[1] - wall,
                {key: came - values.get(key, 0) for key, came in before[2].items()},
                delays,
                tuple(marks.stops.longest),
                before[3] - lost,
                before[4][0] - looks,
                before[4][1] - fits,
            )
        )
        marks.stops.longest.clear()
