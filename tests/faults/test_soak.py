"""Days of many loops, a fault on every bus every hour, in virtual time: nothing grows, no alarm is false."""

import asyncio
import gc
import itertools
import math
import os
from contextlib import asynccontextmanager
from pathlib import Path

import numpy as np
import pytest

from agent.analysis.diagnosis import Diagnosis
from agent.analysis.gates import ALL_KINDS, closed_kinds, gates
from agent.analysis.oscillation import detect_oscillation
from agent.analysis.stiction.he_curve_fit import HeCurveFit
from agent.runtime.agent import Agent
from agent.runtime.loop.workers import InlineExecutor
from agent.settings import AgentSettings, AlarmSettings, ConnectionSettings, Settings
from connectors.base import ConnectionLostError, LoopRole, Quality, Sample
from connectors.options import Options, Target
from tests.unit.runtime.agents import virtual
from tests.unit.runtime.loops import START, loop_settings

HOUR = 3600.0
TS = 10.0
BUSES = 5
PERIOD = 20
"""Of the limit cycle, samples."""
WINDOW = 300
"""Samples."""
NOISE = np.random.default_rng(1).normal(0.0, 1.0, 99_991)

FAULTS = (
    "reset",
    "refuse",
    "silence",
    "bug",
    "bad",
    "nan",
    "again",
    "publish",
    "late",
    "clock",
    "leap",
    "hang",
)


class Plant:
    """What the loops of one bus do: OP and PV at a time, of a valve that sticks or not."""

    def __init__(self, bus, loops, sticks_from, sticks_until):
        self.loops = [f"L{bus}{k}" for k in range(loops)]
        self.sticking = self.loops[: max(1, loops // 5)]
        self._sticks = (sticks_from, sticks_until)

    def sticks(self, loop, t):
        return loop in self.sticking and self._sticks[0] <= t < self._sticks[1]

    def values(self, loop, t):
        """OP and PV at ``t``, s after START: a triangle and the square that follows, or noise."""
        k, lane = int(t / TS), 977 * (1 + self.loops.index(loop))
        op = 50 + 0.5 * NOISE[(k + lane) % len(NOISE)]
        pv = 40 + 0.1 * NOISE[(k + 3 * lane) % len(NOISE)]
        if self.sticks(loop, t):
            phase = k % PERIOD / PERIOD
            op = 46 + 8 * abs(2 * phase - 1) + 0.05 * NOISE[(k + lane) % len(NOISE)]
            pv += 2 if (k + 3) % PERIOD < PERIOD / 2 else -2
        return op, pv


class Transport:
    """A bus in memory that has the next of FAULTS every hour."""

    takes_orders = False

    def __init__(self, name, plant, first):
        self.name = name
        self.plant = plant
        self.events = {}
        """Id -> event, as a consumer that honours ids has them."""
        self.faults = 0
        self.bugs = 0
        self._kinds = itertools.islice(itertools.cycle(FAULTS), first, None)
        self._due = HOUR / 2
        self._away_until = 0.0
        self._deaf_until = 0.0
        self._offset = 0.0

    @property
    def _now(self):
        return asyncio.get_running_loop().time()

    @asynccontextmanager
    async def session(self):
        if self._now < self._away_until:
            raise ConnectionLostError("refused")
        yield self

    async def publish(self, publication):
        await asyncio.sleep(0.01)
        if self._now < self._deaf_until:
            raise ConnectionLostError("broken pipe")
        if publication.kind != "event":
            return
        self.events.setdefault(publication.id, publication)
        if self._deaf_until:
            self._deaf_until = 0.0
            raise ConnectionLostError("reset before the answer came")

    async def samples(self):
        while True:
            kind = None
            if self._now >= self._due:
                kind = next(self._kinds)
                self._due += HOUR
                self.faults += 1
            async for sample in self._after(kind):
                yield sample
            for sample in self._rows(self._now):
                yield sample
            await asyncio.sleep(TS - self._now % TS)

    async def _after(self, kind):
        """Have a fault, and yield what it makes the bus say."""
        match kind:
            case "reset":
                raise ConnectionLostError("reset by peer")
            case "refuse" | "hang":
                self._away_until = self._now + (120.0 if kind == "refuse" else 900.0)
                raise ConnectionLostError("reset by peer")
            case "silence":
                await asyncio.sleep(300.0)
            case "bug":
                self.bugs += 1
                raise ZeroDivisionError
            case "bad" | "nan":
                for _ in range(20):
                    for each in self._rows(self._now):
                        yield (
                            Sample(each.tag, each.time, each.value + 50, Quality.BAD, 0x80000000)
                            if kind == "bad"
                            else Sample.measured(each.tag, each.time, math.nan)
                        )
                    await asyncio.sleep(TS)
            case "again":
                for back in range(30, 0, -1):
                    for each in self._rows(self._now - back * TS):
                        yield each
            case "publish":
                self._deaf_until = self._now + 1800.0
            case "late":
                began = self._now
                await asyncio.sleep(55.0)
                for step in range(1, 6):
                    for each in self._rows(began + step * TS):
                        yield each
            case "clock":
                self._offset = 5000.0 - self._offset
            case "leap":
                for each in self._rows(self._now):
                    yield Sample(each.tag, each.time + 50_000.0, each.value)

    def _rows(self, now):
        at = START + now + self._offset
        for loop in self.plant.loops:
            op, pv = self.plant.values(loop, now)
            yield Sample(LoopRole(loop, "pv"), at, pv)
            yield Sample(LoopRole(loop, "op"), at, op)


def diagnose(window, _seen=None):
    """Judge by gates, oscillation and the shape of OP: cheap, and no record of what was put in."""
    seen = detect_oscillation(window)
    if closed_kinds(gates(window, seen)) == ALL_KINDS:
        verdict = "not_testable"
    elif not seen.detected:
        verdict = "no_stiction"
    else:
        verdict = HeCurveFit().detect(window, seen).verdict
        verdict = "stiction" if verdict == "stiction" else "undecided"
    return Diagnosis(window.loop, verdict, 1.0, "undecided", (), None, seen, None)


def resident():
    """Memory of this process, MB."""
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 1e6


async def soaked(hours, loops):
    """Run so many loops on each bus; return its buses, the verdicts, the agent, and what memory did."""
    begins, ends = 0.25 * hours * HOUR, 0.6 * hours * HOUR
    buses = [Transport(f"bus{k}", Plant(k, loops, begins, ends), 2 * k + 1) for k in range(BUSES)]
    verdicts = {}
    settings = Settings(
        agent=AgentSettings(),
        connections={bus.name: ConnectionSettings("memory", Options()) for bus in buses},
        loops=tuple(
            loop_settings(
                loop,
                connection=bus.name,
                ts=TS,
                seconds=WINDOW * TS,
                hop=1.0,
                quantify="always",
                alarm=AlarmSettings(on_delay=1, off_delay=1),
                publish=(Target(connection=bus.name),),
            )
            for bus in buses
            for loop in bus.plant.loops
        ),
    )
    clock = asyncio.get_running_loop()
    agent = Agent(
        settings,
        InlineExecutor(),
        lambda diagnosis: verdicts.setdefault(diagnosis.loop, []).append(diagnosis.verdict),
        connectors=buses,
        diagnose=diagnose,
        clock=lambda: START + clock.time(),
    )
    memory = []
    work = asyncio.create_task(agent.run())
    for part in range(1, 11):
        await asyncio.sleep(part * hours * HOUR / 10 - clock.time())
        assert not work.done()
        gc.collect()
        memory.append((len(gc.get_objects()), resident()))
    work.cancel()
    await asyncio.wait({work})
    return buses, verdicts, agent, memory


@pytest.mark.parametrize(
    ("hours", "loops"),
    [
        pytest.param(6, 2, marks=pytest.mark.timeout(240)),
        pytest.param(30 * 24, 10, marks=[pytest.mark.bench, pytest.mark.timeout(14_400)]),
    ],
)
def test_it_goes_on_for_days(hours, loops, caplog):
    caplog.set_level("CRITICAL")
    buses, verdicts, agent, memory = virtual(soaked(hours, loops))
    assert sum(bus.faults for bus in buses) >= 0.9 * BUSES * hours
    for bus in buses:
        for loop in bus.plant.loops:
            events = [each.fields for each in bus.events.values() if each.subject == loop]
            told = [(fields["active"], fields["time"] - START) for fields in events]
            if loop not in bus.plant.sticking:
                assert told == [], f"a false alarm of {loop}"
                continue
            assert [active for active, _ in told] == [True, False], loop
            assert verdicts[loop].count("stiction") >= 1
    assert [each.health.faults for each in agent.connections] == [bus.bugs for bus in buses]
    assert all(health.faults == 0 for health in agent.health.values())
    assert sum(v.count("not_testable") for v in verdicts.values()) < 0.3 * sum(map(len, verdicts.values()))
    objects = [count for count, _ in memory]
    assert max(objects[4:]) - objects[3] < 2000
    assert memory[-1][1] - memory[3][1] < 20
