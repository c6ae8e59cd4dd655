"""The history in PostgreSQL: every entry once, whatever dies on the way. Against a real server."""

import asyncio
import contextlib
import json
import math
from dataclasses import replace

import numpy as np
import psycopg
import pytest
import yaml

from agent.cli import main
from agent.runtime.agent import Agent
from agent.runtime.loop.workers import InlineExecutor
from agent.runtime.store import forwarder as module
from agent.runtime.store.database import StoreError
from agent.runtime.store.history import History
from agent.runtime.store.history_file import Entry, HistoryFile
from agent.runtime.store.kept_window import KeptWindow
from agent.runtime.store.postgres_history import PostgresHistory, history_forwarder
from agent.settings import AgentSettings, ConnectionSettings, HistoryDatabase, HistorySettings, Settings
from agent.settings.load import settings_of
from connectors.base import ConfigError
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
        connection.execute("DROP TABLE IF EXISTS slipjump_entry, slipjump_window, slipjump_origin")
    return HistoryDatabase(url=postgres.url, tls=False)


def entry(number, time=None):
    return Entry(float(number if time is None else time), "FIC101", "note", {"n": number, "comment": "ü"})


def window_of(number, n=600):
    """A window with a gap, of which each value belongs to its number."""
    pv = np.arange(n) / 8 + number
    pv[1] = np.nan
    grid = np.arange(n, dtype=np.float32)
    return KeptWindow(number + 0.25, 0.5, {"op": grid, "pv": pv.astype(np.float32), "sp": grid + 1})


def write(path, entries, now=0.0):
    file = HistoryFile(path)
    file.write(entries, now)
    file.close()


def rows(postgres):
    """Return number and content of each row, as they were written."""
    with psycopg.connect(postgres.url) as connection:
        text = "SELECT origin::text, number, content FROM slipjump_entry ORDER BY origin, number"
        return connection.execute(text).fetchall()


def numbers(postgres):
    return [content["n"] for _, _, content in rows(postgres)]


def sent(path, database):
    return all_sent(history_forwarder(path, database))


def test_entries_arrive_once_in_their_order_and_are_read_back(tmp_path, postgres, database, monkeypatch):
    monkeypatch.setattr(module, "BATCH", 7)
    path = tmp_path / "a.sqlite"
    entries = [entry(k) for k in range(30)]
    write(path, entries)
    sent(path, database)
    write(path, [entry(30)])
    for _ in range(2):
        sent(path, database)
    assert numbers(postgres) == list(range(31))
    with contextlib.closing(PostgresHistory(database, create=False)) as history:
        assert history.read() == (*entries, entry(30))
        assert history.read("FIC101", 28.0, 2) == (entry(29), entry(30))
        assert history.read("FIC999") == ()


def test_an_answer_that_is_lost_doubles_nothing(tmp_path, postgres, database, monkeypatch):
    path = tmp_path / "a.sqlite"
    write(path, [entry(k) for k in range(5)])
    whole = PostgresHistory.take

    def takes_and_is_cut_off(self, *words):
        whole(self, *words)
        raise StoreError("connection lost")

    monkeypatch.setattr(PostgresHistory, "take", takes_and_is_cut_off)
    with pytest.raises(StoreError):
        sent(path, database)
    monkeypatch.setattr(PostgresHistory, "take", whole)
    write(path, [entry(5)])
    sent(path, database)
    assert numbers(postgres) == list(range(6))


def test_half_a_batch_is_none(tmp_path, postgres, database, monkeypatch):
    path = tmp_path / "a.sqlite"
    write(path, [entry(k) for k in range(5)])
    with contextlib.closing(PostgresHistory(database)) as history:
        monkeypatch.setattr("agent.runtime.store.postgres_history._row", lambda *_: (None,) * 7)
        with pytest.raises(StoreError, match="null value"):
            history.take("0b0e6a4e-7c1f-4a3a-9d0c-000000000001", HistoryFile(path).after(0, 10))
    monkeypatch.undo()
    assert rows(postgres) == []
    sent(path, database)
    assert numbers(postgres) == list(range(5))


def test_agents_share_a_database(tmp_path, postgres, database):
    for name in ("a", "b"):
        write(tmp_path / f"{name}.sqlite", [entry(k) for k in range(3)])
        sent(tmp_path / f"{name}.sqlite", database)
    write(tmp_path / "a.sqlite", [entry(3)])
    sent(tmp_path / "a.sqlite", database)
    assert sorted(numbers(postgres)) == [0, 0, 1, 1, 2, 2, 3]


def test_no_content_holds_up_what_comes_after_it(tmp_path, postgres, database):
    path = tmp_path / "a.sqlite"
    odd = {"n": 0, "s": math.nan, "list": [math.inf, "a\0b"], "text": "\ud800", "deep": {"\0k": None}}
    write(path, [Entry(time, "L\0", "note", odd) for time in (1e300, -1e300, math.inf, -1.0)])
    write(path, [entry(1)])
    sent(path, database)
    assert numbers(postgres) == [0, 0, 0, 0, 1]
    assert rows(postgres)[0][2] == {"n": 0, "s": None, "list": [None, "ab"], "text": "?", "deep": {"k": None}}


def test_what_a_full_file_dropped_meanwhile_is_counted(tmp_path, postgres, database, caplog):
    path = tmp_path / "a.sqlite"
    write(path, [entry(k) for k in range(4)])
    forwarder = history_forwarder(path, database)
    forwarder.send()
    for k in range(4, 8):
        write(path, [entry(k)], now=float(k))
    file = HistoryFile(path)
    file.forget(6.0, 1e9)
    forwarder.send()
    assert (forwarder.dropped, numbers(postgres)) == (2, [0, 1, 2, 3, 6, 7])
    assert "2 entries were dropped" in caplog.text
    file.forget(100.0, 1e9)
    assert [each.number for each in file.after(0, 9)] == [8], "numbers never begin anew"
    file.close()
    forwarder._let_go()


def test_windows_come_with_their_verdicts_and_are_read_back_as_they_were(tmp_path, postgres, database):
    path = tmp_path / "a.sqlite"
    lost = replace(entry(2), window=window_of(2).without_values())
    write(path, [entry(0), replace(entry(1), window=window_of(1)), lost])
    forwarder = sent(path, database)
    assert forwarder.dropped == 1, "a window whose values the full file dropped is counted"
    assert numbers(postgres) == [0, 1, 2]
    with contextlib.closing(PostgresHistory(database, create=False)) as history:
        listed = history.windows()
        found = history.window("FIC101", 1.0, 1.5)
        assert history.window("FIC101", 2.0, 2.5) is None
        assert history.windows("FIC102") == history.windows(None, 1.5) == ()
    assert [(each.loop, each.end, each.start, each.ts, each.samples) for each in listed] == [
        ("FIC101", 1.0, 1.25, 0.5, 600)
    ]
    assert (found.start, found.ts, list(found.columns)) == (1.25, 0.5, ["op", "pv", "sp"])
    for name, column in window_of(1).columns.items():
        np.testing.assert_array_equal(found.columns[name], column)


@pytest.mark.parametrize("lengths", [LENGTHS, pytest.param(A_MINUTE, marks=pytest.mark.bench)])
async def test_a_database_that_is_killed_under_load_loses_and_doubles_nothing(
    tmp_path, postgres, database, monkeypatch, caplog, lengths
):
    for name, value in (("AGAIN", 0.05), ("PAUSE", 0.01), ("BATCH", 100)):
        monkeypatch.setattr(module, name, value)
    monkeypatch.setattr("agent.runtime.store.history.GATHER", 0.01)
    path = tmp_path / "a.sqlite"
    history, forwarder = History(path, HistorySettings(database=database)), history_forwarder(path, database)
    tasks = [asyncio.create_task(history.run()), asyncio.create_task(forwarder.run())]

    def put(k):
        history.noted(replace(entry(k), window=window_of(k) if k % 3 == 0 else None))

    load = Load(put, burst=2)
    await outages(postgres, forwarder, load, lengths, meanwhile=200)
    count = load.count
    end = asyncio.get_running_loop().time() + DEADLINE
    while forwarder.sent < count:
        assert asyncio.get_running_loop().time() < end
        await asyncio.sleep(0.05)
    for task in tasks:
        task.cancel()
    await asyncio.gather(*tasks, return_exceptions=True)
    await history.close()
    await forwarder.close()
    assert numbers(postgres) == list(range(count))
    with psycopg.connect(postgres.url) as connection:
        text = "SELECT pv[1], array_length(pv, 1), mv FROM slipjump_window ORDER BY number"
        assert connection.execute(text).fetchall() == [(k, 600, None) for k in range(0, count, 3)]
    assert history.dropped == forwarder.dropped == 0
    noticed = [each for each in caplog.messages if "entries wait in the file" in each]
    assert len(lengths) <= len(noticed) <= 2 * len(lengths), "one line an outage, however long it lasts"
    assert sum("takes entries again" in each for each in caplog.messages) in (0, len(noticed))


async def test_an_agent_sends_what_it_finds_with_the_methods(tmp_path, postgres, database, monkeypatch):
    monkeypatch.setattr(module, "PAUSE", 0.01)
    kept = HistorySettings(database=database)
    settings = Settings(
        AgentSettings(state=tmp_path / "plant.sqlite", clock_error=None, history=kept),
        {"bus": ConnectionSettings("fake", Options())},
        (loop_settings(seconds=400.0, hop=0.25, quantify="always"),),
    )
    bus = FakeBus(stream(["FIC101"], 700, step=0.0))
    agent = Agent(settings, InlineExecutor(), lambda _: None, connectors=[bus], diagnose=judged())
    task = asyncio.create_task(agent.run())
    async with asyncio.timeout(DEADLINE):
        while agent.forwarders[0].sent < 3:  # noqa: ASYNC110 - the test has no event of the agent
            await asyncio.sleep(0.01)
    task.cancel()
    await asyncio.wait({task})
    found = [content for _, _, content in await asyncio.to_thread(rows, postgres)]
    verdicts = [content["verdict"] for content in found if "methods" in content]
    alarms = [content["state"] for content in found if "state" in content]
    assert (verdicts[0], alarms, len(verdicts) + 1) == ("stiction", ["unacked_active"], len(found))


def test_the_command_shows_the_database(tmp_path, postgres, database, capsys):
    path = tmp_path / "plant.history.sqlite"
    write(
        path,
        [
            Entry(float(k), "FIC101", "note", {"action": "tagged", "by": "me", "comment": ""})
            for k in range(3)
        ],
    )
    sent(path, database)
    tags = {role: {"topic": f"plant/{role}"} for role in ("pv", "op")}
    config = {
        "agent": {
            "state": str(tmp_path / "plant.sqlite"),
            "history": {"database": {"url": postgres.url, "tls": False}},
        },
        "connections": {"broker": {"kind": "mqtt", "host": "127.0.0.1"}},
        "loops": [{"name": "FIC101", "connection": "broker", "ts": 1.0, "tags": tags}],
    }
    (tmp_path / "plant.yaml").write_text(yaml.safe_dump(config))
    with pytest.raises(SystemExit) as left:
        main(["history", "--config", str(tmp_path / "plant.yaml"), "--json", "--last", "2"])
    printed = capsys.readouterr()
    assert left.value.code == 0, printed.err
    assert [json.loads(line)["time"] for line in printed.out.splitlines()] == [1.0, 2.0]


def test_passwords_are_in_no_message(postgres, monkeypatch):
    url = "postgresql://me:s3cret@db/history"
    with pytest.raises(ConfigError) as fault:
        settings_of({"agent": {"history": {"database": {"url": url}}}, "connections": {}, "loops": []})
    assert "s3cret" not in str(fault.value)
    monkeypatch.setenv("PASSWORD", "s3cret")
    for given in ({"tls": True}, {"tls": False, "url": postgres.url.replace("/postgres", "/nothing")}):
        settings = HistoryDatabase.model_validate(
            {"url": postgres.url, "password": {"env": "PASSWORD"}} | given
        )
        with pytest.raises(StoreError) as refused:
            PostgresHistory(settings)
        assert str(refused.value).startswith(str(settings.url))
        assert "s3cret" not in str(refused.value)
    absent = HistoryDatabase.model_validate({"url": postgres.url, "password": {"env": "NOT_THERE"}})
    with pytest.raises(StoreError, match="NOT_THERE is not set"):
        PostgresHistory(absent)
