"""What is remembered of a valve outlives the process, and goes into the next window."""

import asyncio
import sqlite3
from dataclasses import replace

import numpy as np
import pytest

from agent.alarms import Alarm, Delay
from agent.analysis.evidence.weighing import Weighed
from agent.analysis.memory.sticks import with_sticks
from agent.analysis.memory.valve_memory import ValveMemory, remember
from agent.analysis.results import ProcessEstimate, ProcessIntervals
from agent.runtime.loop.pipeline import LoopPipeline
from agent.runtime.loop.workers import InlineExecutor
from agent.runtime.store.change import Change
from agent.runtime.store.journal import Journal
from agent.runtime.store.store import Store
from agent.settings import AlarmSettings
from tests.unit.analysis.diagnoses import HEALTHY, STICKING, WINDOW, judged
from tests.unit.runtime.loops import loop_settings, sample

DAY = 86400.0


def certain(verdict="undecided"):
    """A window that shows stiction and a process."""
    ends = ProcessIntervals((1.4, 1.6), (4.0, 6.0), (1.0, 3.0))
    process = ProcessEstimate("fopdt", 1.5, 5.0, 2.0, intervals=ends)
    alone = judged(WINDOW, STICKING)
    return replace(
        alone,
        verdict=verdict,
        quantification=replace(alone.quantification, process=process),
        weighed=Weighed(0.99, ()),
        no_response=None,
    )


def remembered(days=4):
    memory = ValveMemory()
    for k in range(days):
        memory = remember(memory, certain(), 1.6e9 + k * DAY, 1.6e9 + k * DAY + 3600.0)
    return memory


@pytest.fixture
def path(tmp_path):
    return tmp_path / "plant.sqlite"


class Watcher:
    """Waits for the first verdict."""

    def __init__(self):
        self.done = asyncio.Event()

    def judged(self, _):
        self.done.set()

    def announced(self, _):
        pass


def opened(path, work):
    store = Store(path)
    try:
        return work(store)
    finally:
        store.close()


def test_the_store_gives_a_memory_back(path):
    memory = remembered()
    opened(path, lambda store: store.write(Change(memories={"FIC101": memory})))
    kept = opened(path, Store.read).memories["FIC101"]
    assert kept.probability() == pytest.approx(memory.probability(), rel=1e-5)
    assert kept.until == memory.until


def test_a_file_of_an_older_version_gets_its_table(path):
    opened(path, lambda store: store.write(Change({"FIC101": Alarm("FIC101")})))
    with sqlite3.connect(path) as database:
        database.execute("DROP TABLE memory")
    kept = opened(path, Store.read)
    assert kept.memories == {}
    assert set(kept.alarms) == {"FIC101"}
    opened(path, lambda store: store.write(Change(memories={"FIC101": remembered()})))
    assert set(opened(path, Store.read).memories) == {"FIC101"}


def test_a_memory_that_cannot_be_read_is_logged_and_skipped(path, caplog):
    opened(path, lambda store: store.write(Change(memories={"A": remembered(), "B": remembered()})))
    with sqlite3.connect(path) as database:
        database.execute("UPDATE memory SET content = '{}' WHERE loop = 'A'")
    assert set(opened(path, Store.read).memories) == {"B"}
    assert "cannot read what is remembered of A" in caplog.text


def test_the_newest_memory_of_changes_together_counts():
    older, newer = remembered(1), remembered(2)
    both = Change(memories={"A": older}).followed_by(Change(memories={"A": newer}))
    assert both.memories == {"A": newer}
    assert both.taken == frozenset()


async def test_a_window_updates_the_memory_and_the_next_one_gets_the_process(path):
    seen = []

    def diagnosed(window, _seen=None):
        seen.append(window.hints.known)
        return with_sticks(certain("no_stiction"))

    journal, watcher = Journal(path), Watcher()
    await journal.open()
    pipeline = LoopPipeline(
        loop_settings(quantify="always"), InlineExecutor(), (), [watcher], diagnosed, journal
    )
    pipeline.resume(None, remembered())
    before = pipeline.memory.windows
    task = asyncio.create_task(pipeline.run())
    values = 50 + np.sin(np.arange(60))
    for k, value in enumerate(values.tolist()):
        for role in ("pv", "op"):
            pipeline.push(sample(role, float(k), value), float(k))
        await asyncio.sleep(0)
    async with asyncio.timeout(10):
        await watcher.done.wait()
    task.cancel()
    await asyncio.gather(task, return_exceptions=True)
    await journal.close()
    assert seen[0].gain == pytest.approx(1.5)
    assert pipeline.memory.windows != before
    assert pipeline.diagnosis.sticks.probability > 0.5
    assert pipeline.alarm.advisory == "shelved"
    assert not pipeline.alarm.state.active
    kept = opened(path, Store.read).memories["FIC101"]
    assert kept.until == pytest.approx(pipeline.memory.until)


def test_an_advisory_is_active_only_where_the_settings_say_so():
    suspected = with_sticks(certain("undecided"))
    for setting, state in (("shelved", "shelved"), ("active", "active")):
        alarm = AlarmSettings(on_delay=1, off_delay=1, advisory=setting)
        pipeline = LoopPipeline(loop_settings(alarm=alarm), InlineExecutor())
        found, announced = pipeline.alarm.on_diagnosis(suspected, 10.0)
        assert found.advisory == state
        assert not found.state.active
        assert [each.kind for each in announced] == ["state"]
        assert announced[0].fields()["advisory"] == state
    sound, _ = Alarm("X", delay=Delay(1, 1)).on_diagnosis(judged(WINDOW, HEALTHY), 1.0)
    assert sound.advisory == "none"
