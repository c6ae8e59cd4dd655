"""What was, remembered on disk: bounded, off the event loop, and shown by `slipjump history`."""

import _sqlite3
import asyncio
import ctypes
import json
import sqlite3

import pytest
from typer.testing import CliRunner

from agent.alarms import Alarm, Delay
from agent.cli import app, main
from agent.runtime.agent import Agent
from agent.runtime.loop.pipeline import Judged
from agent.runtime.loop.workers import InlineExecutor
from agent.runtime.store import history as module
from agent.runtime.store.history import DAY, History
from agent.runtime.store.history_file import Entry, HistoryFile, history_path
from agent.settings import AgentSettings, ConnectionSettings, HistorySettings, Settings
from connectors.options import Options
from tests.unit.alarms.test_alarm import diagnosis
from tests.unit.runtime.agents import judged, stream
from tests.unit.runtime.fake_bus import FakeBus
from tests.unit.runtime.loops import START, loop_settings


@pytest.fixture
def path(tmp_path):
    return tmp_path / "plant.history.sqlite"


def entry(number, loop="FIC101", time=None, size=10):
    return Entry(float(number if time is None else time), loop, "diagnosis", {"n": number, "x": "y" * size})


def opened(path, work):
    file = HistoryFile(path)
    try:
        return work(file)
    finally:
        file.close()


def test_it_gives_back_the_newest_of_a_loop_from_a_time_on(path):
    entries = [entry(k, loop=f"FIC10{k % 2}") for k in range(10)]
    opened(path, lambda file: file.write(entries, 0.0))
    assert opened(path, lambda file: file.read()) == tuple(entries)
    assert opened(path, lambda file: file.read("FIC101", 4.0)) == tuple(entries[5::2])
    assert opened(path, lambda file: file.read(limit=3)) == tuple(entries[7:])


def test_what_is_too_old_goes_whatever_clock_its_source_had(path):
    def work(file):
        file.write([entry(1, time=4e9), entry(2, time=0.0)], 1000.0)
        file.write([entry(3, time=-1.0)], 2000.0)
        file.forget(1500.0, 1e9)
        return [each.content["n"] for each in file.read()]

    assert opened(path, work) == [3]


def test_the_file_stays_below_its_size_and_keeps_the_newest(path):
    def work(file):
        for k in range(60):
            file.write([entry(100 * k + n, size=300) for n in range(100)], float(k))
            file.forget(0.0, 1e6)
        return [each.content["n"] for each in file.read()]

    kept = opened(path, work)
    assert kept == list(range(kept[0], 6000))
    assert 1500 < len(kept) < 4000
    assert path.stat().st_size < 1_100_000


def test_memory_does_not_grow_with_what_is_kept(path):
    used = ctypes.CDLL(_sqlite3.__file__).sqlite3_memory_used
    used.restype = ctypes.c_int64

    def grown(file):
        file.write([entry(0)], 0.0)
        before = used()
        for k in range(60):
            file.write([entry(50 * k + n, size=1000) for n in range(50)], 0.0)
        return used() - before

    assert opened(path, grown) < 500_000
    assert path.stat().st_size > 3_000_000


async def test_an_agent_remembers_verdicts_and_alarms(tmp_path):
    state = tmp_path / "plant.sqlite"
    settings = Settings(
        AgentSettings(state=state, clock_error=None),
        {"bus": ConnectionSettings("fake", Options())},
        (loop_settings(seconds=400.0, hop=0.25, quantify="always"),),
    )
    bus = FakeBus(stream(["FIC101"], 700, step=0.0))
    seen = []
    agent = Agent(settings, InlineExecutor(), seen.append, connectors=[bus], diagnose=judged())
    task = asyncio.create_task(agent.run())
    async with asyncio.timeout(30):
        while not seen:  # noqa: ASYNC110 - the test has no event of the agent
            await asyncio.sleep(0.01)
    task.cancel()
    await asyncio.wait({task})
    shown = CliRunner().invoke(app, ["history", "--state", str(state), "--json"])
    lines = [json.loads(line) for line in shown.output.splitlines()]
    assert [line["kind"] for line in lines].count("alarm") == 1
    verdicts = [line for line in lines if line["kind"] == "diagnosis"]
    assert len(verdicts) == len(seen)
    assert (verdicts[0]["verdict"], verdicts[0]["loop"]) == ("stiction", "FIC101")
    assert (verdicts[-1]["time"] - START - 399.0) % 100.0 == 0.0
    table = CliRunner().invoke(app, ["history", "--state", str(state), "--loop", "FIC101"]).output
    assert "ALARM unacked active" in table


async def test_what_the_disk_does_not_take_waits_bounded_and_is_reported_once(tmp_path, monkeypatch, caplog):
    monkeypatch.setattr(module, "LIMIT", 5)
    monkeypatch.setattr(module, "GATHER", 0.0)
    monkeypatch.setattr(module, "AGAIN", 0.01)
    folder = tmp_path / "not yet"
    history = History(folder / "h.sqlite", HistorySettings(), clock=lambda: 10 * DAY)
    writer = asyncio.create_task(history.run())
    for k in range(8):
        history.judged(Judged(diagnosis("stiction"), float(k), 1.0, fitted=True))
        await asyncio.sleep(0.02)
    assert history.dropped == 3
    folder.mkdir()
    async with asyncio.timeout(30):
        while history._waiting:  # noqa: ASYNC110 - as above
            await asyncio.sleep(0.01)
    alarm, said = Alarm("FIC101", delay=Delay(1, 1)).on_diagnosis(diagnosis("stiction"), 9.0)
    history.announced(said[-1])
    writer.cancel()
    await asyncio.wait({writer})
    await history.close()
    kept = opened(folder / "h.sqlite", lambda file: file.read())
    assert [each.time for each in kept] == [3.0, 4.0, 5.0, 6.0, 7.0, 9.0]
    assert kept[-1].content["id"] == alarm.id
    assert caplog.text.count("unable to open") == 1


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--state", "nowhere.sqlite"], "nowhere.history.sqlite: is not there"),
        ([], "name the agent's file"),
        (["--state", "plant.sqlite", "--since", "yesterday"], "is not a time like"),
    ],
)
def test_what_cannot_be_shown_is_reported_in_a_line(path, words, told, monkeypatch, capsys):
    opened(path, lambda file: file.write([entry(1)], 0.0))
    monkeypatch.chdir(path.parent)
    with pytest.raises(SystemExit) as ended:
        main(["history", *words])
    assert ended.value.code == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert told in line


def test_its_file_is_beside_the_state(path):
    assert history_path(path.parent / "plant.sqlite") == path


def test_the_file_of_another_program_is_left_alone(path):
    with sqlite3.connect(path) as other:
        other.execute("CREATE TABLE entry (x)")
    other.close()
    with pytest.raises(Exception, match="belongs to another program"):
        HistoryFile(path)
