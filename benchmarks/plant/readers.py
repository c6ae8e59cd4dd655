"""What reads the plant: a real agent with its page and workers, as ``slipjump run`` has it."""

from __future__ import annotations

import asyncio
import time
from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

from agent.alarms import Announcement
from agent.analysis.diagnosis import Diagnosis
from agent.cli.common.page import serve_page
from agent.runtime.agent import Agent
from agent.runtime.capabilities import run_event_loop
from agent.runtime.intake.gathering import Gatherings
from agent.runtime.loop.judged import Judged
from agent.runtime.loop.workers import PoolExecutor
from agent.runtime.operate import heap
from agent.runtime.operate.breath import breathing
from agent.runtime.supervisor import Health
from agent.settings import HttpSettings, load_settings
from benchmarks.plant.marks import Marks, Stops, answer
from connectors.readings import Readings

WATCHED = 50
"""Of so many loops one has the delay of each sample from wire to window measured."""


class _Windows:
    """Counts windows that were judged, and those with a fit."""

    def __init__(self) -> None:
        self.looks, self.fits = 0, 0

    def judged(self, judged: Judged) -> None:
        self.looks += 1
        self.fits += judged.fitted

    def announced(self, _: Announcement) -> None: ...


def agent(config: Path, quiet: Diagnosis, says: Connection) -> None:
    """Run the agent of a configuration; each loop has this diagnosis, so a scrape is as large as later."""
    settings = load_settings(config)
    heap.keep_one_heap()

    async def main() -> None:
        marks, windows = Marks(Stops()), _Windows()
        async with PoolExecutor(settings.agent.workers) as executor:
            made = Agent(settings, executor)
            made.observe(windows)
            made.accompany(Health("heap"), heap.keep_settled)
            serve_page(made, settings.agent.http or HttpSettings(), lambda _: None)
            bus_of = {loop.name: str(loop.connection) for loop in settings.loops}
            for k, (name, pipeline) in enumerate(made.pipelines.items()):
                pipeline.diagnosis, pipeline.judged_at = replace(quiet, loop=name), 0.0
                if k % WATCHED == 0:
                    _watch(pipeline, marks.delays.setdefault(bus_of[name], []))
            _watch_gatherings(lambda loop: marks.delays.setdefault(bus_of[loop], []))

            async def count() -> dict[str, int]:
                found = Counter[str]()
                async for name, pipeline in breathing(made.pipelines.items()):
                    found[bus_of[name]] += pipeline.window.counters.samples
                return found

            marks.lost = lambda: sum(each.lost for each in made.connections)
            marks.judged = lambda: (windows.looks, windows.fits)
            work = asyncio.create_task(made.run(heap.settle))
            watching = asyncio.create_task(marks.stops.watch())
            await answer(says, count, marks)
            watching.cancel()
            work.cancel()
            await asyncio.wait({work, watching})

    run_event_loop(main())


def _watch_gatherings(delays_of: Callable[[str], list[float]]) -> None:
    put = Gatherings.put

    def timed(gatherings: Gatherings, readings: Readings, arrival: float) -> None:
        put(gatherings, readings, arrival)
        delays_of(readings.tags[0].loop).append(time.time() - readings.time)

    Gatherings.put = timed  # type: ignore[method-assign]


def _watch(pipeline: Any, delays: list[float]) -> None:  # noqa: ANN401 - its method is replaced
    """Watch the samples that come alone; those that come in one piece pass ``Gatherings.put``."""
    push = pipeline.push

    def timed(sample: Any, arrival: float) -> None:  # noqa: ANN401
        push(sample, arrival)
        delays.append(time.time() - sample.time)

    pipeline.push = timed
