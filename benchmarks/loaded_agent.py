"""200 loops with real fits on few workers: windows that are judged, and when valves that stick have alarms.

The pipelines, their turns and their alarms are those of the agent, in virtual time; a worker is held for the
CPU time that a diagnosis really takes here, so a busy machine changes nothing. A tenth of the loops stick;
of those a quarter have a PV that stands still for 25 % of each window, which makes fits long. Of the sound
ones every tenth swings with a load, so that it has fits as well. A window is diagnosed once for all rows.
"""

from __future__ import annotations

import asyncio
import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any, TypeVar

import async_solipsism
import numpy as np

from agent.analysis.routine import Routine
from agent.analysis.seen import Seen
from agent.runtime.loop.judged import Judged
from agent.runtime.loop.pipeline import LoopPipeline
from agent.runtime.loop.turns import Turns
from agent.settings import LoopSettings
from agent.settings.models import WindowSettings
from benchmarks.cases.options import Options
from benchmarks.tables.markdown import table
from connectors.base import LoopRole, Sample
from connectors.options import Options as BusOptions
from simulators.draws.random_plants import random_plant
from simulators.plant import SimulatedRecord, simulate

LOOPS = 200
STICKING = 0.1
FROZEN_OF = 4
"""Of the loops that stick, every fourth has a PV that stands still now and then."""
LOADED_OF = 10
"""Of the sound loops, every tenth swings with a load."""
SEED = 61000
"""First of the loops; nothing was set on them."""
SAMPLES, HOP = 1000, 0.25
"""Of a window; the next is due after a quarter of it."""
FROZEN = 0.25
"""Part of PV that stands still."""
DUE_EVERY = {"a plant in real time": 225.0, "thirty times as fast": 7.5}
"""Time from one window of a loop to the next, s: 900 s with hop 0.25, and the case of issue 30."""
WINDOWS = 6
"""Of each loop: three in a row that accuse the valve make an alarm."""
WORKERS = (1, 2)

T = TypeVar("T")


class KnownWindows:
    """Diagnoses that were made, with the CPU time that each took."""

    def __init__(self) -> None:
        self._known: dict[tuple[str, str, float], tuple[Routine | Seen, float]] = {}

    def diagnosed(self, work: partial[Routine | Seen]) -> tuple[Routine | Seen, float]:
        """Return the diagnosis of a window and its CPU time, s."""
        window = work.args[0]
        key = work.func.__name__, window.loop, window.start
        if key not in self._known:
            started = time.process_time()
            found = work()
            self._known[key] = found, time.process_time() - started
        return self._known[key]


@dataclass
class MeteredWorkers:
    """An executor in virtual time: a place is held for the CPU time that the work takes."""

    turns: Turns
    known: KnownWindows
    quick: list[float] = field(default_factory=list)
    """CPU time of each window without a fit, s."""
    fits: list[float] = field(default_factory=list)
    """CPU time of each with a fit, s."""

    @property
    def queued(self) -> int:
        return self.turns.waiting

    async def run(self, function: Callable[..., T], *args: object) -> T:
        async with self.turns.turn(0.0):
            return function(*args)

    async def run_in_turn(self, expected: float, work: Callable[[], Any], worth: float = 1.0) -> Any:  # noqa: ANN401
        async with self.turns.turn(expected, worth):
            found, took = self.known.diagnosed(work())
            (self.fits if isinstance(found, Routine) and found.fitted else self.quick).append(took)
            await asyncio.sleep(took)
            return found


@dataclass
class Heard:
    """What became of the windows of one loop."""

    sticks: bool
    first_due: float | None = None
    """When its first window was due, virtual s."""
    alarmed: float | None = None
    """When its alarm came, virtual s."""
    waits: list[float] = field(default_factory=list)
    """From due to judged, of windows without a fit, s."""

    def judged(self, judged: Judged) -> None:
        if not judged.fitted:
            self.waits.append(judged.took)

    def announced(self, announcement: object) -> None:
        alarm = getattr(announcement, "alarm", None)
        if self.alarmed is None and alarm is not None and alarm.state.active:
            self.alarmed = asyncio.get_running_loop().time()


def run(options: Options) -> None:
    """Print the tables."""
    count = LOOPS if options.loops is None else options.loops
    records = [recorded(k, sticks=k < STICKING * count) for k in range(count)]
    known, rows = KnownWindows(), []
    for workers in WORKERS:
        for name, every in DUE_EVERY.items():
            rows.append((name, workers, *loaded(records, every, workers, known)))
    columns = (
        "load",
        "workers",
        "due",
        "judged",
        "due a second",
        "judged a second",
        "judged a CPU second",
        "fit: CPU s, median, 90 %, longest",
        "sticking with an alarm",
        "s to it: median, longest",
        "sound with an alarm",
        "quick waited at most, s",
    )
    print(table(f"### {count} loops with real fits, {WINDOWS} windows each", columns, rows))


def recorded(number: int, *, sticks: bool) -> tuple[SimulatedRecord, float, bool]:
    """Return the record of a loop, its sampling time, and whether its valve sticks."""
    kind = "stiction" if sticks else "sinusoid" if number % LOADED_OF == 0 else "none_noise"
    scenario = random_plant(SEED + number, kind)
    samples = round(SAMPLES * (1 + HOP * (WINDOWS - 1))) + 1
    record = simulate(scenario.model_copy(update={"duration": samples * scenario.ts}))
    if sticks and number % FROZEN_OF == 0:
        record = replace(record, pv=frozen(record.pv))
    return record, scenario.ts, sticks


def frozen(pv: np.ndarray) -> np.ndarray:
    """Return PV with stretches in which its last value stands, a quarter of the time."""
    held, cycle = pv.copy(), SAMPLES
    for begin in range(cycle // 2, len(pv), cycle):
        held[begin : begin + round(FROZEN * cycle)] = pv[begin]
    return held


def loaded(
    records: list[tuple[SimulatedRecord, float, bool]], every: float, workers: int, known: KnownWindows
) -> tuple[object, ...]:
    """Run all loops in virtual time; return the cells of a row."""
    with asyncio.Runner(loop_factory=async_solipsism.EventLoop) as runner:
        return runner.run(_loaded(records, every, workers, known))


async def _loaded(
    records: list[tuple[SimulatedRecord, float, bool]], every: float, workers: int, known: KnownWindows
) -> tuple[object, ...]:
    clock = asyncio.get_running_loop()
    metered = MeteredWorkers(Turns(workers), known)
    heard = [Heard(sticks) for _, _, sticks in records]
    pipelines, tasks = [], []
    for k, (record, ts, _) in enumerate(records):
        pipeline = LoopPipeline(_settings(k, ts), metered, observers=[heard[k]])
        pipelines.append(pipeline)
        tasks.append(asyncio.create_task(pipeline.run()))
        lag = every * k / len(records)
        tasks.append(asyncio.create_task(_played(pipeline, record, ts, every, lag, heard[k])))
    until = every * (WINDOWS - 1 + 1 / HOP + 1)
    await asyncio.sleep(until)
    began = min(each.first_due for each in heard if each.first_due is not None)
    for each in tasks:
        each.cancel()
    await asyncio.gather(*tasks, return_exceptions=True)
    judged = len(metered.quick) + len(metered.fits)
    due = len(records) * WINDOWS
    passed = clock.time() - began
    cpu = sum(metered.quick) + sum(metered.fits)
    sticking = [each for each in heard if each.sticks]
    to_alarm = [
        each.alarmed - each.first_due
        for each in sticking
        if each.alarmed is not None and each.first_due is not None
    ]
    waits = [wait for each in heard for wait in each.waits]
    fits = metered.fits or [float("nan")]
    return (
        due,
        judged,
        f"{len(records) / every:.1f}",
        f"{judged / passed:.1f}",
        f"{judged / cpu:.1f}",
        f"{np.median(fits):.2f}, {np.quantile(fits, 0.9):.2f}, {max(fits):.2f}",
        f"{len(to_alarm)} of {len(sticking)}",
        f"{np.median(to_alarm):.0f}, {max(to_alarm):.0f}" if to_alarm else "",
        sum(each.alarmed is not None for each in heard if not each.sticks),
        f"{max(waits):.1f}" if waits else "",
    )


async def _played(
    pipeline: LoopPipeline, record: SimulatedRecord, ts: float, every: float, lag: float, heard: Heard
) -> None:
    """Give a pipeline its samples, so fast that a window is due ``every`` s."""
    clock = asyncio.get_running_loop()
    await asyncio.sleep(lag)
    name, step, block = pipeline.settings.name, every / (SAMPLES * HOP), round(SAMPLES * HOP / 10)
    start = 1.7e9
    for k in range(len(record.pv)):
        if k % block == 0:  # in blocks: a timer for each sample would take longer than the fits
            await asyncio.sleep(max(lag + k * step - clock.time(), 0.0))
        arrival = clock.time()
        pipeline.push(Sample.measured(LoopRole(name, "pv"), start + k * ts, float(record.pv[k])), arrival)
        pipeline.push(Sample.measured(LoopRole(name, "op"), start + k * ts, float(record.op[k])), arrival)
        if heard.first_due is None and pipeline.busy:
            heard.first_due = arrival


def _settings(number: int, ts: float) -> LoopSettings:
    seconds = SAMPLES * ts
    return LoopSettings(
        name=f"FIC{number:03d}",
        connection="plant",
        ts=ts,
        tags={role: BusOptions() for role in ("pv", "op")},
        window=WindowSettings(seconds=seconds, hop=HOP),
    )
