"""What outlives the process: alarms, unpublished messages and commands."""

import asyncio
import os
import sqlite3
from contextlib import closing

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from agent.alarms import Alarm, Command, Delay, Event
from agent.runtime.link.outbox import Outbox
from agent.runtime.store.change import Change, Waiting
from agent.runtime.store.database import Database
from agent.runtime.store.journal import Journal
from agent.runtime.store.store import Store, StoreError
from connectors.base import Publication
from tests.unit.alarms.test_alarm import play


@pytest.fixture
def path(tmp_path):
    return tmp_path / "plant.sqlite"


def event(number):
    return Publication(
        "FIC101", "event", f"e{number}", {"n": number, "x": 0.5, "text": "5", "on": True, "no": None}
    )


def waiting(number):
    return Waiting("broker", event(number))


def opened(path, work):
    store = Store(path)
    try:
        return work(store)
    finally:
        store.close()


def test_a_new_file_that_another_connection_makes_meanwhile_is_shared(path, monkeypatch):
    """As writer and forwarder of the history do: both have seen that it is empty."""
    make = Database._make

    def behind_another(database, connection):
        monkeypatch.undo()
        opened(path, lambda store: store.write(Change(put={1: waiting(1)})))
        make(database, connection)

    monkeypatch.setattr(Database, "_make", behind_another)
    assert opened(path, Store.read).waiting == {1: waiting(1)}


def test_it_gives_back_what_it_was_given(path):
    alarm, _ = play(Alarm("FIC101", delay=Delay(1, 3)), ["stiction", "no_stiction"])
    alarm, _ = alarm.on_command(Command(Event.SHELVE, "jane", 10.0, until=500.0))
    change = Change({"FIC101": alarm}, {1: waiting(1), 2: waiting(2)})
    opened(path, lambda store: store.write(change))
    kept = opened(path, Store.read)
    assert kept.alarms == change.alarms
    assert kept.waiting == change.put
    assert [type(value) for value in kept.waiting[1].publication.fields.values()] == [
        int,
        float,
        str,
        bool,
        type(None),
    ]
    opened(path, lambda store: store.write(Change(removed=frozenset({1, 2}))))
    kept = opened(path, Store.read)
    assert kept.waiting == {}
    assert kept.sequence == 2  # remembered, though nothing waits


def test_a_change_is_written_whole_or_not_at_all(path):
    opened(path, lambda store: store.write(Change(put={1: waiting(1)})))
    unfit = Change({"FIC101": Alarm("FIC101")}, {2: Waiting(None, event(2))}, frozenset({1}))
    with pytest.raises(StoreError, match="NOT NULL"):
        opened(path, lambda store: store.write(unfit))
    kept = opened(path, Store.read)
    assert (list(kept.waiting), kept.alarms) == ([1], {})


CHANGES = st.builds(
    lambda put, removed: Change(put={n: waiting(n) for n in put - removed}, removed=frozenset(removed)),
    st.sets(st.integers(0, 9)),
    st.sets(st.integers(0, 9)),
)


def applied(there, change):
    return (there | set(change.put)) - change.removed


@given(st.sets(st.integers(100, 109)), st.lists(CHANGES, max_size=4))
@settings(max_examples=100)
def test_changes_together_do_what_they_do_one_by_one(before, changes):
    one_by_one, together = before, Change()
    for k, each in enumerate(changes):
        # Numbers are given once: what is put anew is another one.
        change = Change(
            put={10 * k + n: one for n, one in each.put.items()},
            removed=frozenset(10 * k + n for n in each.removed) | frozenset(sorted(one_by_one)[:2]),
        )
        one_by_one = applied(one_by_one, change)
        together = together.followed_by(change)
    assert applied(before, together) == one_by_one


def test_commands_wait_in_order_until_they_are_taken(path):
    first = Command(Event.ACKNOWLEDGE, "jane", 1.0)
    second = Command(Event.SHELVE, "joe", 2.0, until=9.0)
    numbers = [opened(path, lambda store, c=c: store.command("FIC101", c)) for c in (first, second)]
    told = opened(path, Store.commands)
    assert [(each.number, each.loop, each.command) for each in told] == [
        (numbers[0], "FIC101", first),
        (numbers[1], "FIC101", second),
    ]
    opened(path, lambda store: store.write(Change(taken=frozenset(numbers[:1]))))
    assert [each.number for each in opened(path, Store.commands)] == numbers[1:]


def test_rows_that_cannot_be_read_are_logged_and_skipped(path, caplog):
    opened(
        path, lambda store: store.write(Change({"FIC101": Alarm("FIC101")}, {1: waiting(1), 2: waiting(2)}))
    )
    with sqlite3.connect(path) as database:
        database.execute("UPDATE alarm SET content = '{}'")
        database.execute("UPDATE outbox SET content = 'x' WHERE sequence = 1")
        database.execute("INSERT INTO command (loop, content) VALUES ('FIC101', '{\"event\": \"raise\"}')")
    database.close()
    kept = opened(path, Store.read)
    assert (kept.alarms, list(kept.waiting)) == ({}, [2])
    assert opened(path, Store.commands)[0].command is None
    assert caplog.text.count("cannot read") == 3


@pytest.mark.parametrize("damage", ["no database", "cut", "scrambled"])
def test_a_damaged_file_is_moved_aside(path, caplog, damage):
    opened(path, lambda store: store.write(Change(put={n: waiting(n) for n in range(200)})))
    content = path.read_bytes()
    match damage:
        case "no database":
            broken = b"not a database, " * 1000
        case "cut":
            broken = content[: len(content) // 2]
        case _:
            broken = content[:4096] + bytes(reversed(content[4096:]))
    path.write_bytes(broken)
    assert opened(path, Store.read).waiting == {}
    assert "a new one is made" in caplog.text
    (aside,) = path.parent.glob("plant.sqlite.damaged-*")
    assert aside.read_bytes() == broken


def test_a_damaged_file_is_left_alone_by_who_may_not_make_one(path):
    path.write_bytes(b"not a database, " * 1000)
    with pytest.raises(StoreError, match="not a database"):
        Store(path, create=False)
    assert [each.name for each in path.parent.iterdir()] == ["plant.sqlite"]


@pytest.mark.parametrize(
    ("statement", "told"),
    [("PRAGMA application_id = 7", "another program"), ("PRAGMA user_version = 99", "has version 99")],
)
def test_a_file_that_is_not_ours_is_left_as_it_is(path, statement, told):
    opened(path, Store.read)
    with sqlite3.connect(path) as database:
        database.execute(statement)
    database.close()
    before = path.read_bytes()
    with pytest.raises(StoreError, match=told):
        Store(path)
    assert path.read_bytes() == before


async def test_a_full_disk_is_logged_once_and_nothing_is_lost(path, caplog):
    journal = Journal(path)
    await journal.open()
    outbox = Outbox("broker", journal)
    limit = journal._store._database._database

    def bound(pages):
        return journal._in_thread(lambda: limit.execute(f"PRAGMA max_page_count = {pages}").fetchone())

    await bound(1)  # SQLite then allows as many as there are
    for k in range(200):
        outbox.put(event(k))
        await journal.flush()
    assert journal.failures > 100
    sent = await outbox.first()  # published all the same
    assert sent.id == "e0"
    outbox.taken(sent)
    await bound(1_000_000)
    await journal.flush()
    assert len(opened(path, Store.read).waiting) == 199
    await journal.close()
    told = [record.message for record in caplog.records if record.name.endswith("journal")]
    assert len(told) == 1
    assert "full" in told[0]


async def test_a_store_that_cannot_be_made_is_made_when_it_can(tmp_path, caplog):
    path = tmp_path / "not yet" / "plant.sqlite"
    journal = Journal(path)
    assert (await journal.open()).waiting == {}
    outbox = Outbox("broker", journal)
    outbox.put(event(1))
    assert (await outbox.first()).id == "e1"
    assert journal.failures >= 2
    path.parent.mkdir()
    await journal.flush()
    await journal.close()
    assert [each.publication.id for each in opened(path, Store.read).waiting.values()] == ["e1"]
    assert len([record for record in caplog.records if "unable to open" in record.message]) == 1


async def test_nothing_is_sent_before_it_is_on_disk(path):
    journal = Journal(path)
    await journal.open()
    outbox = Outbox("broker", journal)
    sender = asyncio.create_task(outbox.first())
    await asyncio.sleep(0)
    for k in range(20):
        outbox.put(event(k))
    sent = await sender
    kept = opened(path, Store.read).waiting
    assert sent.id in {each.publication.id for each in kept.values()}
    await journal.close()


def _removed(path):
    path.unlink()


def _replaced(path):
    other = path.with_name("other.sqlite")
    Store(other).close()
    other.replace(path)


def _overwritten(path):
    with closing(sqlite3.connect(path)) as database:
        database.execute("PRAGMA wal_checkpoint(TRUNCATE)")  # else the log mends it
    size = path.stat().st_size
    path.write_bytes(b"garbage!" * (size // 8))
    os.utime(path, ns=(1, 1))


@pytest.mark.parametrize("harm", [_removed, _replaced, _overwritten])
async def test_a_file_that_somebody_removes_or_overwrites_is_noticed_and_written_anew(harm, tmp_path, caplog):
    path = tmp_path / "state.sqlite"
    journal = Journal(path)
    await journal.open()
    outbox = Outbox("broker", journal)
    outbox.put(Publication("FIC101", "state", "1", {}))
    await journal.flush()
    harm(path)
    await journal.commands()  # the agent looks for them every second
    assert "removed, replaced or overwritten" in caplog.text
    outbox.put(Publication("FIC102", "state", "2", {}))
    await journal.flush()
    assert journal.problem == ""
    await journal.close()
    store = Store(path)
    assert [each.publication.subject for each in store.read().waiting.values()] == ["FIC101", "FIC102"]
    store.close()
    assert caplog.text.count("removed, replaced or overwritten") == 1


async def test_commands_of_another_process_are_no_harm(tmp_path, caplog):
    path = tmp_path / "state.sqlite"
    journal = Journal(path)
    await journal.open()
    other = Store(path, create=False)
    for k in range(3):
        other.command("FIC101", Command(Event.ACKNOWLEDGE, "me", float(k)))
        other._database._database.execute("PRAGMA wal_checkpoint")
        assert len(await journal.commands()) == k + 1
    other.close()
    await journal.close()
    assert "overwritten" not in caplog.text
