"""What reads the plant: a real agent with its page and workers; and how it reports to the benchmark."""

from __future__ import annotations

import asyncio
import math
import time
from collections.abc import Awaitable, Callable
from dataclasses import dataclass, replace
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

import numpy as np

from agent.analysis.diagnosis import Diagnosis
from agent.cli.common.page import serve_page
from agent.runtime.agent import Agent
from agent.runtime.capabilities import run_event_loop
from agent.runtime.intake.gathering import Gatherings
from agent.runtime.loop.workers import PoolExecutor
from agent.runtime.operate import heap
from agent.runtime.operate.breath import breathing
from agent.settings import HttpSettings, load_settings
from connectors.readings import Readings

WATCHED = 50
"""Of so many loops one has the delay of each sample from wire to window measured."""
WATCH = "watch"
"""What the parent sends to have the loop watched from now on; True ends that."""
TICK = 0.02
"""How often it is seen whether the loop that reads stands still, s."""


@dataclass(frozen=True)
class Read:
    """What a reader says of the time between two marks."""

    cpu: float
    """Of its process, s."""
    wall: float
    values: int
    """Of all roles, that reached it."""
    delays: tuple[float, ...] = ()
    """From the sending of a sample to its place in a window, s."""
    stops: tuple[float, ...] = ()
    """How long the loop that reads stood still, s, the longest ten."""
    lost: int = 0

    @property
    def value_cost(self) -> float:
        """CPU of one value, s; NaN where none came."""
        return self.cpu / self.values if self.values else math.nan


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


def agent(config: Path, quiet: Diagnosis, says: Connection) -> None:
    """Run the agent of a configuration as ``slipjump run`` does, each loop with this diagnosis."""
    settings = load_settings(config)
    heap.keep_one_heap()

    async def main() -> None:
        stops, delays = Stops(), list[float]()
        async with PoolExecutor(settings.agent.workers) as executor:
            made = Agent(settings, executor)
            serve_page(made, settings.agent.http or HttpSettings(), lambda _: None)
            for k, (name, pipeline) in enumerate(made.pipelines.items()):
                pipeline.diagnosis, pipeline.judged_at = replace(quiet, loop=name), 0.0
                if k % WATCHED == 0:
                    _watch(pipeline.window, delays)
            _watch_gatherings(delays)

            async def count() -> int:
                pipelines = made.pipelines.values()
                return sum([each.window.counters.samples async for each in breathing(pipelines)])

            def lost() -> int:
                return sum(each.lost for each in made.connections)

            work = asyncio.create_task(made.run(heap.settle))
            watching = asyncio.create_task(stops.watch())
            await answer(says, count, stops, delays, lost)
            watching.cancel()
            work.cancel()
            await asyncio.wait({work, watching})

    run_event_loop(main())


def _watch_gatherings(delays: list[float]) -> None:
    put = Gatherings.put

    def timed(gatherings: Gatherings, readings: Readings, arrival: float) -> None:
        put(gatherings, readings, arrival)
        delays.append(time.time() - readings.time)

    Gatherings.put = timed  # type: ignore[method-assign]


def _watch(window: Any, delays: list[float]) -> None:  # noqa: ANN401 - its method is replaced
    push = window.push

    def timed(sample: Any, arrival: float) -> Any:  # noqa: ANN401
        found = push(sample, arrival)
        delays.append(time.time() - sample.time)
        return found

    window.push = timed


async def answer(
    says: Connection,
    count: Callable[[], Awaitable[int]],
    stops: Stops | None,
    delays: list[float],
    lost: Callable[[], int],
) -> None:
    """Answer each mark of the parent with what happened since the one before; end on an empty one.

    Args:
        says: To the parent.
        count: Returns how many values came.
        stops: Where they are watched.
        delays: Filled by who measures them, s.
        lost: Returns how many were lost.
    """
    before = cpu, wall, values, missed = time.process_time(), time.perf_counter(), await count(), lost()
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
        if stops is not None:
            (stops.wanted.set if wanted == WATCH else stops.wanted.clear)()
        cpu, wall, values, missed = before
        before = time.process_time(), time.perf_counter(), await count(), lost()
        says.send(
            Read(
                before[0] - cpu,
                before[1] - wall,
                before[2] - values,
                tuple(np.quantile(delays, [0.5, 0.99, 1.0])) if delays else (),
                tuple(stops.longest) if stops is not None and stops.longest else (0.0,),
                before[3] - missed,
            )
        )
        delays.clear()
        if stops is not None:
            stops.longest.clear()
