"""What was, remembered on disk: bounded, off the event loop, and shown by `slipjump history`."""

import _sqlite3
import asyncio
import ctypes
import json
import sqlite3
from dataclasses import replace

import numpy as np
import pytest
from typer.testing import CliRunner

from agent.alarms import Alarm, Delay
from agent.analysis.record.recording import LoopWindow
from agent.cli import main
from agent.cli.commands import app
from agent.runtime.agent import Agent
from agent.runtime.loop.judged import Judged
from agent.runtime.loop.workers import InlineExecutor
from agent.runtime.store import history as module
from agent.runtime.store.history import DAY, History
from agent.runtime.store.history_file import Entry, HistoryFile, history_path
from agent.runtime.store.kept_window import KeptWindow, window_id
from agent.settings import AgentSettings, ConnectionSettings, HistorySettings, Settings
from connectors.options import Options
from tests.unit.alarms.test_alarm import diagnosis
from tests.unit.runtime.agents import judged, stream
from tests.unit.runtime.fake_bus import FakeBus
from tests.unit.runtime.loops import START, cut_of, loop_settings


@pytest.fixture
def path(tmp_path):
    return tmp_path / "plant.history.sqlite"


def entry(number, loop="FIC101", time=None, size=10):
    return Entry(float(number if time is None else time), loop, "diagnosis", {"n": number, "x": "y" * size})


def window_of(n, loop="FIC101", start=0.0):
    """A window of n samples with a gap in PV."""
    pv = 50.0 + np.cos(np.arange(n) / 8)
    pv[1:2] = np.nan
    return LoopWindow(loop, start, 0.5, op=40.0 - np.sin(np.arange(n) / 8), pv=pv, automatic=np.full(n, True))


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
        history.judged(Judged(diagnosis("stiction"), float(k), 1.0, fitted=True, cut=cut_of(window_of(4))))
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


def with_window(number, n=400):
    return replace(entry(number), window=KeptWindow.of(window_of(n, start=float(number))))


def test_values_of_windows_go_before_any_verdict_where_the_file_is_full(path):
    def work(file):
        for k in range(40):
            file.write([with_window(k, 2000)], 0.0)
        file.forget(-1.0, 150_000)
        return file.read(), file.windows(), file.after(0, 100), file.lost(0, file.after(0, 100))

    entries, windows, sent, lost = opened(path, work)
    assert len(entries) == len(sent) == 40
    assert 0 < len(windows) < 40
    assert [each.end for each in windows] == [float(k) for k in range(40 - len(windows), 40)]
    assert [len(each.entry.window) for each in sent] == [0] * lost + [2000] * len(windows)


def test_a_window_goes_with_its_verdict(path):
    def work(file):
        file.write([with_window(0)], 0.0)
        file.write([with_window(1)], 100.0)
        file.forget(50.0, 1e9)
        with file._database.reading() as database:
            return database.execute("SELECT number FROM window").fetchall()

    assert opened(path, work) == [(2,)]


def test_what_is_read_together_is_bounded_by_its_windows(path, monkeypatch):
    monkeypatch.setattr("agent.runtime.store.history_file.MOST_BYTES", 1000)
    opened(path, lambda file: file.write([with_window(k, 2000) for k in range(5)], 0.0))
    assert [len(opened(path, lambda file, k=k: file.after(k, 10))) for k in range(6)] == [1, 1, 1, 1, 1, 0]


@pytest.mark.parametrize(
    ("verdict", "alarmed", "wanted", "kept"),
    [
        ("stiction", False, True, True),
        ("stiction", True, False, False),
        ("no_stiction", True, True, True),
        ("no_stiction", False, True, False),
        ("undecided", False, True, False),
    ],
)
async def test_which_windows_are_kept(path, verdict, alarmed, wanted, kept):
    history = History(path, HistorySettings(windows=wanted), clock=lambda: 0.0)
    window = window_of(8)
    history.judged(Judged(diagnosis(verdict), 9.5, 1.0, fitted=True, cut=cut_of(window), alarmed=alarmed))
    await history.close()
    assert len(opened(path, lambda file: file.windows())) == kept
    if kept:
        found = opened(path, lambda file: file.window("FIC101", 9.5, 9.6))
        assert (found.start, found.ts, len(found)) == (0.0, 0.5, 8)
        np.testing.assert_array_equal(found.columns["pv"], window.pv.astype(np.float32))
        assert set(found.columns) == {"op", "pv", "automatic"}


async def test_windows_that_wait_for_the_disk_are_bounded_and_their_verdicts_stay(path, monkeypatch):
    monkeypatch.setattr(module, "LIMIT_WINDOWS", 2)
    history = History(path, HistorySettings(), clock=lambda: 0.0)
    for k in range(5):
        history.judged(Judged(diagnosis("stiction"), float(k), 1.0, fitted=True, cut=cut_of(window_of(8))))
    await history.close()
    assert [len(each.entry.window) for each in opened(path, lambda file: file.after(0, 9))] == [8, 8, 0, 0, 0]


def test_a_kept_window_becomes_a_recording_that_is_diagnosed(tmp_path, capsys):
    state = tmp_path / "plant.sqlite"
    window = KeptWindow.of(window_of(600, start=START))
    kept = Entry(window.end, "FIC101", "diagnosis", {}, window)
    opened(history_path(state), lambda file: file.write([kept], 0.0))
    words = ["history", "--state", str(state)]
    listed = CliRunner().invoke(app, [*words, "--windows", "--json"]).output
    name = json.loads(listed)["window"]
    assert name == window_id("FIC101", window.end)
    assert name in CliRunner().invoke(app, [*words, "--windows"]).output
    target = tmp_path / "FIC101.csv"
    assert CliRunner().invoke(app, [*words, "--window", name, "--csv", str(target)]).exit_code == 0
    lines = target.read_text().splitlines()
    assert (lines[0], len(lines)) == ("time,OP,PV,mode", 601)
    cells = [line.split(",")[1:] for line in lines[1:]]
    assert [float(op) for op, _, _ in cells] == pytest.approx(window.columns["op"], rel=1e-8)
    assert [pv for _, pv, _ in cells[:2]] == ["51", ""]
    assert {mode for _, _, mode in cells} == {"AUTO"}
    with pytest.raises(SystemExit) as left:
        main(["diagnose", "--json", str(target)])
    said = json.loads(capsys.readouterr().out)
    assert (left.value.code, said["loop"]) == (0, "FIC101")


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--window", "FIC101@2026-11-22T06:00:00Z", "--csv", "{}"], "no window FIC101@"),
        (["--window", "FIC101", "--csv", "{}"], "is not the id of a window"),
        (["--window", "FIC101@2026-11-22T06:00:00Z"], "each only with the other"),
    ],
)
def test_a_window_that_is_not_there_is_named(tmp_path, capsys, words, said):
    state = tmp_path / "plant.sqlite"
    opened(history_path(state), lambda file: file.write([entry(0)], 0.0))
    target = str(tmp_path / "x.csv")
    with pytest.raises(SystemExit) as left:
        main(["history", "--state", str(state), *(target if word == "{}" else word for word in words)])
    assert left.value.code == 2
    assert said in " ".join(capsys.readouterr().err.split())
