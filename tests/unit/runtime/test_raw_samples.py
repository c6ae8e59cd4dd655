"""Raw samples: a minute of a loop in a row, each once, a gap marked. Against a real server where one is."""

import asyncio
import contextlib
import math

import numpy as np
import psycopg
import pytest

from agent.runtime.agent import Agent
from agent.runtime.loop.workers import InlineExecutor
from agent.runtime.samples import recorder as module
from agent.runtime.samples.minute import Minute, OpenMinute
from agent.runtime.samples.postgres_samples import PostgresSamples, samples_forwarder
from agent.runtime.samples.recorder import SampleRecorder
from agent.runtime.samples.sample_file import SampleFile, SampleGap, samples_path
from agent.runtime.store import forwarder as sending
from agent.runtime.store.postgres_history import PostgresHistory
from agent.settings import (
    AgentSettings,
    ConnectionSettings,
    HistoryDatabase,
    HistorySettings,
    SampleSettings,
    Settings,
)
from connectors.base import LoopRole, Quality, Sample
from connectors.options import Options
from tests.outages import A_MINUTE, LENGTHS, Load, all_sent, outages
from tests.unit.runtime.agents import judged, stream
from tests.unit.runtime.fake_bus import FakeBus
from tests.unit.runtime.loops import loop_settings

DEADLINE = 60.0


@pytest.fixture
def database(postgres):
    """Settings of an empty database."""
    with psycopg.connect(postgres.url, autocommit=True) as connection:
        for name in ("entry", "window", "sample", "gap", "origin"):
            connection.execute(f"DROP TABLE IF EXISTS slipjump_{name}")
    return HistoryDatabase(url=postgres.url, tls=False, samples=SampleSettings())


def came(role, time, value, quality=Quality.GOOD, loop="FIC101"):
    return Sample(LoopRole(loop, role), time, value, quality)


def minute_of(number, loop="FIC101", n=60):
    """A minute of OP, PV and SP reported together, each value a number of its own."""
    made = OpenMinute(loop, number)
    for k in range(n):
        for role in ("op", "pv", "sp"):
            made.put(came(role, 60.0 * number + k, number + k / 64, loop=loop), 0.0)
    return made


def asked(postgres, text):
    with psycopg.connect(postgres.url) as connection:
        return connection.execute(text).fetchall()


def written(path, minutes, gap=None, max_bytes=1e9):
    with contextlib.closing(SampleFile(path)) as file:
        file.write(minutes, gap)
        file.forget(max_bytes)


def sent(path, database):
    return all_sent(samples_forwarder(path, database))


def test_a_minute_is_a_table_by_time():
    made = OpenMinute("FIC101", 10)
    for role, time, value, quality in [
        ("pv", 602.0, 2.0, Quality.GOOD),
        ("pv", 601.0, 1.0, Quality.UNCERTAIN),
        ("op", 601.0, 8.0, Quality.GOOD),
        ("op", 602.5, 9.0, Quality.BAD),
        ("op", 601.0, 7.0, Quality.GOOD),
        ("mode", 602.0, "AUTO", Quality.GOOD),
    ]:
        made.put(came(role, time, value, quality), 0.0)
    minute = made.table()
    again = Minute.unpacked("FIC101", 600.0, minute.packed())
    for each in (minute, again):
        assert (each.loop, each.start, list(each.at)) == ("FIC101", 600.0, [10**6, 2 * 10**6, 25 * 10**5])
        assert each.columns["pv"].tolist() == [1.0, 2.0, None]
        op = each.columns["op"].tolist()
        assert op[:2] == [7.0, None]
        assert math.isnan(op[2])
        assert each.mode == (None, "AUTO", None)
        assert list(each.quality) == [1, 0, 2]
    assert minute_of(3).table().quality is None


def test_rows_of_the_database_are_what_came(tmp_path, postgres, database):
    path = tmp_path / "a.samples.sqlite"
    apart = OpenMinute("L\0", 7)
    apart.put(came("pv", 421.0, 1.5), 0.0)
    apart.put(came("op", 422.0, 2.5, Quality.BAD), 0.0)
    apart.put(came("mode", 422.0, "MAN"), 0.0)
    written(path, [minute_of(5, n=2), apart])
    sent(path, database)
    text = (
        "SELECT extract(epoch FROM time)::int, loop, at, op, pv, sp, mv, mode, quality FROM slipjump_sample"
    )
    first, second = asked(postgres, f"{text} ORDER BY number")
    values = [5.0, 5.015625]
    assert first == (300, "FIC101", [0, 1_000_000], values, values, values, None, None, None)
    assert second[:3] == (420, "L", [1_000_000, 2_000_000])
    assert second[3][0] is None
    assert math.isnan(second[3][1])
    assert second[4:] == ([1.5, None], None, None, [None, "MAN"], [0, 2])


def test_every_table_with_a_time_can_be_a_hypertable(postgres, database):
    """TimescaleDB allows no unique index without the time, and no foreign key to a hypertable."""
    with contextlib.closing(PostgresHistory(database)), contextlib.closing(PostgresSamples(database)):
        pass
    unique = "SELECT relname FROM pg_index JOIN pg_class ON pg_class.oid = indrelid WHERE indisunique"
    assert asked(postgres, unique + " AND relname LIKE 'slipjump%'") == [("slipjump_origin",)]
    foreign = "SELECT 1 FROM pg_constraint WHERE contype = 'f' AND conname LIKE 'slipjump%'"
    assert asked(postgres, foreign) == []
    timed = (
        "SELECT table_name FROM information_schema.columns WHERE column_name = 'time' "
        "AND is_nullable = 'NO' AND table_name LIKE 'slipjump%' ORDER BY 1"
    )
    assert asked(postgres, timed) == [(f"slipjump_{name}",) for name in ("entry", "gap", "sample", "window")]


def test_a_loop_second_takes_sixteen_bytes_and_its_part_of_a_row(tmp_path, postgres, database):
    path = tmp_path / "a.samples.sqlite"
    written(path, [minute_of(k) for k in range(600)])
    sent(path, database)
    (size,) = asked(postgres, "SELECT avg(pg_column_size(s.*)) FROM slipjump_sample s")[0]
    assert 16.0 < float(size) / 60 < 20.0
    with contextlib.closing(SampleFile(path, create=False)) as file:
        assert file.after(0, 9) == (), "what the database has waits no longer"


def test_an_answer_that_is_lost_doubles_nothing(tmp_path, postgres, database, monkeypatch):
    path = tmp_path / "a.samples.sqlite"
    written(path, [minute_of(k) for k in range(5)])
    monkeypatch.setattr(SampleFile, "delivered", lambda *_: None)
    sent(path, database)
    written(path, [minute_of(5)])
    sent(path, database)
    monkeypatch.undo()
    written(path, [minute_of(6)])
    sent(path, database)
    found = asked(postgres, "SELECT pv[1] FROM slipjump_sample ORDER BY number")
    assert [value for (value,) in found] == list(range(7))


def test_where_the_file_is_full_the_gap_is_marked_and_counted(tmp_path, postgres, database):
    path = tmp_path / "a.samples.sqlite"
    for k in range(0, 300, 10):
        written(path, [minute_of(n) for n in range(k, k + 10)], max_bytes=150_000)
    forwarder = sent(path, database)
    kept = [int(value) for (value,) in asked(postgres, "SELECT pv[1] FROM slipjump_sample ORDER BY number")]
    ((since, until, minutes),) = asked(
        postgres, "SELECT extract(epoch FROM time), extract(epoch FROM until), minutes FROM slipjump_gap"
    )
    assert kept == list(range(int(minutes), 300))
    assert 50 < len(kept) < 250
    assert (since, until) == (0, 60 * (minutes - 1))
    assert forwarder.dropped == minutes


async def test_what_the_disk_does_not_take_is_bounded_and_marked(tmp_path, monkeypatch):
    monkeypatch.setattr(module, "LIMIT", 3)
    monkeypatch.setattr(module, "LOOK", 0.01)
    folder = tmp_path / "not yet"
    recorder = SampleRecorder(folder / "a.samples.sqlite", 100.0)
    writer = asyncio.create_task(recorder.run())
    for k in range(10):
        recorder.put(came("pv", 60.0 * k, float(k)), 0.0)
        await asyncio.sleep(0.03)
    recorder.put(came("pv", math.nan, 1.0), 0.0)
    folder.mkdir()
    writer.cancel()
    await asyncio.wait({writer})
    await recorder.close()
    with contextlib.closing(SampleFile(folder / "a.samples.sqlite")) as file:
        gap, *rest = [each.content for each in file.after(0, 99)]
    assert gap == SampleGap(0.0, 360.0, 7)
    assert [each.columns["pv"].tolist() for each in rest] == [[7.0], [8.0], [9.0]]


async def test_a_file_that_was_removed_is_begun_anew(tmp_path, monkeypatch, caplog):
    monkeypatch.setattr(module, "LOOK", 0.01)
    path = tmp_path / "a.samples.sqlite"
    recorder = SampleRecorder(path, 100.0)
    writer = asyncio.create_task(recorder.run())
    for k in range(3):
        recorder.put(came("pv", 60.0 * k, float(k)), 0.0)
    async with asyncio.timeout(DEADLINE):
        while not path.exists() or not _minutes(path):  # noqa: ASYNC110 - another thread writes
            await asyncio.sleep(0.02)
    path.unlink()
    recorder.put(came("pv", 180.0, 3.0), 0.0)
    writer.cancel()
    await asyncio.wait({writer})
    await recorder.close()
    assert [each.content.start for each in _minutes(path)] == [180.0]
    assert caplog.text.count("was removed or replaced; it is begun anew") == 1


def _minutes(path):
    with contextlib.closing(SampleFile(path)) as file:
        return file.after(0, 99)


@pytest.mark.parametrize("lengths", [LENGTHS, pytest.param(A_MINUTE, marks=pytest.mark.bench)])
async def test_a_database_that_is_killed_under_load_loses_and_doubles_nothing(
    tmp_path, postgres, database, monkeypatch, lengths
):
    monkeypatch.setattr(sending, "AGAIN", 0.05)
    monkeypatch.setattr(sending, "PAUSE", 0.01)
    monkeypatch.setattr(sending, "BATCH", 100)
    monkeypatch.setattr(module, "LOOK", 0.01)
    path = tmp_path / "a.samples.sqlite"
    recorder, forwarder = SampleRecorder(path, 100.0), samples_forwarder(path, database)
    tasks = [asyncio.create_task(recorder.run()), asyncio.create_task(forwarder.run())]
    load = Load(lambda k: recorder.put(came("pv", 7.0 * k, float(k)), 0.0), burst=20)
    await outages(postgres, forwarder, load, lengths, meanwhile=4000)
    for task in tasks:
        task.cancel()
    await asyncio.wait(tasks)
    await recorder.close()
    await forwarder.close()
    await asyncio.to_thread(sent, path, database)
    rows = await asyncio.to_thread(
        asked, postgres, "SELECT time, at, pv FROM slipjump_sample ORDER BY number"
    )
    found = [(start.timestamp() + a / 1e6, v) for start, at, pv in rows for a, v in zip(at, pv, strict=True)]
    assert found == [(7.0 * k, float(np.float32(k))) for k in range(load.count)]
    assert await asyncio.to_thread(asked, postgres, "SELECT * FROM slipjump_gap") == []


async def test_an_agent_keeps_what_came(tmp_path, postgres, database):
    settings = Settings(
        AgentSettings(
            state=tmp_path / "plant.sqlite", clock_error=None, history=HistorySettings(database=database)
        ),
        {"bus": ConnectionSettings("fake", Options())},
        (loop_settings(seconds=400.0, hop=0.25, quantify="always"),),
    )
    bus = FakeBus(stream(["FIC101"], 700, step=0.0))
    agent = Agent(settings, InlineExecutor(), lambda _: None, connectors=[bus], diagnose=judged())
    task = asyncio.create_task(agent.run())
    async with asyncio.timeout(DEADLINE):
        while agent.pipelines["FIC101"].window.counters.samples < 1400:  # noqa: ASYNC110 - as elsewhere
            await asyncio.sleep(0.01)
    task.cancel()
    await asyncio.wait({task})
    await asyncio.to_thread(sent, samples_path(tmp_path / "plant.sqlite"), database)
    with contextlib.closing(await asyncio.to_thread(PostgresSamples, database)):
        rows = await asyncio.to_thread(asked, postgres, "SELECT at, op, pv, quality FROM slipjump_sample")
    assert sum(len(at) for at, _, _, _ in rows) >= 700
    assert {quality for _, _, _, quality in rows} == {None}
    assert not any(None in op or None in pv for _, op, pv, _ in rows)
