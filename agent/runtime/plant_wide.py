"""PLANT-WIDE: which loops of the running agent oscillate together, looked at again and again.

Each look takes the newest values of the loops, in a worker and behind what the loops themselves want of it.
Its cost is bounded: at most ``MOST_LOOPS`` loops of ``MOST_SAMPLES`` samples, once in ``EVERY``.
"""

from __future__ import annotations

import asyncio
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, NoReturn

import numpy as np

from agent.analysis.gates.record import MIN_SAMPLES
from agent.analysis.plant.plant import PlantFinding, plant_finding
from agent.analysis.record.recording import LoopWindow
from agent.runtime.supervisor import MARGIN, Health

if TYPE_CHECKING:
    from agent.runtime.loop.pipeline import LoopPipeline
    from agent.runtime.loop.workers import Executor

EVERY = 3600.0
"""From the end of one look to the next, s: an oscillation of a plant lasts for days."""
MOST_LOOPS = 60
"""Loops that are compared; those that oscillate come first."""
MOST_SAMPLES = 4000
"""Newest samples of each: forty of the longest periods that are seen in it."""
EXPECTED = 5.0
"""Usual time of a look at ``MOST_LOOPS`` loops in a worker, s (``benchmarks.plant_wide``)."""
WORTH = 0.1
"""Of a look, beside a usual fit that waits for a worker."""
LATE = 0.1
"""Part of what is compared by which a loop may lag behind the newest value; it would cut the time of all."""


@dataclass(frozen=True, slots=True)
class PlantLook:
    """What one look found."""

    time: float
    """When, s UTC."""
    finding: PlantFinding
    left_out: int
    """Loops that were not compared."""


class PlantWide:
    """Looks at all loops together. ``run`` is for a supervisor."""

    def __init__(
        self,
        pipelines: Mapping[str, LoopPipeline],
        executor: Executor,
        clock: Callable[[], float] = time.time,
        every: float = EVERY,
    ) -> None:
        """Make it.

        Args:
            pipelines: Of the loops, by name; may change.
            executor: Runs the comparison.
            clock: Returns the time, s UTC.
            every: Time from one look to the next, s.
        """
        self.health = Health("plant-wide")
        self.newest: PlantLook | None = None
        """None before the first look."""
        self._pipelines = pipelines
        self._executor = executor
        self._clock = clock
        self._every = every

    async def run(self) -> NoReturn:
        """Look again and again, until cancelled."""
        while True:
            self.health.expect("look", self._every + MARGIN)
            await asyncio.sleep(self._every)
            self.health.expect("look", None)  # a worker has a limit of its own
            await self.look()

    async def look(self) -> PlantLook:
        """Compare the loops as they are now.

        Raises:
            TimeoutError: The comparison took too long.
        """
        windows, diagnoses = [], []
        for name in ranked(self._pipelines):
            pipeline = self._pipelines.get(name)
            window = None if pipeline is None else newest_of(pipeline)
            if pipeline is not None and window is not None:
                windows.append(window)
                if pipeline.diagnosis is not None:
                    diagnoses.append(pipeline.diagnosis)
            if len(windows) == MOST_LOOPS:
                break
            await asyncio.sleep(0)
        kept = together(windows)
        work = partial(plant_finding, kept, diagnoses)
        finding = await self._executor.run_in_turn(EXPECTED, lambda: work, WORTH)
        self.newest = PlantLook(self._clock(), finding, len(self._pipelines) - len(finding.compared))
        return self.newest


def ranked(pipelines: Mapping[str, LoopPipeline]) -> list[str]:
    """Return the names of the loops, those first whose newest window oscillates most regularly."""

    def key(name: str) -> tuple[float, str]:
        diagnosis = pipelines[name].diagnosis
        seen = None if diagnosis is None else diagnosis.oscillation
        if seen is None or not seen.detected:
            return (0.0, name)
        return (-1.0 - (seen.regularity or 0.0), name)

    return sorted(pipelines, key=key)


def newest_of(pipeline: LoopPipeline) -> LoopWindow | None:
    """Return the newest values of a loop; None where there are too few."""
    ts = pipeline.settings.ts
    newest = pipeline.window.newest
    if newest is None:
        return None
    start, columns = pipeline.window.recent(newest - MOST_SAMPLES * ts)
    op, pv, sp = columns["op"], columns["pv"], columns.get("sp")
    if min(len(op), len(pv)) < MIN_SAMPLES or len(op) != len(pv):
        return None
    given = sp is not None and len(sp) == len(pv) and bool(np.isfinite(sp).any())
    return LoopWindow(pipeline.settings.name, start, ts, op, pv, sp if given else None)


def together(windows: list[LoopWindow]) -> list[LoopWindow]:
    """Return the windows without those whose newest value is much older than that of the others."""
    ends = {each.loop: each.start + len(each) * each.ts for each in windows}
    last = max(ends.values(), default=0.0)
    return [each for each in windows if last - ends[each.loop] <= LATE * len(each) * each.ts]
