"""What befalls a history file and its database while the agent writes and sends."""

import asyncio
import contextlib
from pathlib import Path

import pytest

from agent.runtime.store import history as module
from agent.runtime.store.database import StoreError
from agent.runtime.store.forwarder import Forwarder
from agent.runtime.store.history import DAY, History
from agent.runtime.store.history_file import HistoryFile
from agent.settings import HistoryDatabase, HistorySettings
from tests.unit.runtime.test_history import entry, opened


@pytest.fixture
def path(tmp_path):
    return tmp_path / "plant.history.sqlite"


class NumbersByFile:
    """Keeps numbers of entries by the file that they are of."""

    def __init__(self):
        self.kept = {}

    def position(self, origin):
        return self.kept.get(origin, [0])[-1]

    def take(self, origin, rows):
        self.kept.setdefault(origin, []).extend(each.number for each in rows)

    def close(self):
        pass


class AnswersOnceTooLate(NumbersByFile):
    """Keeps the first rows, but its answer is lost with the connection."""

    def take(self, origin, rows):
        first = not self.kept
        super().take(origin, rows)
        if first:
            raise StoreError("the server closed the connection unexpectedly")


@contextlib.asynccontextmanager
async def written_and_sent(path, database, monkeypatch):
    """A history that is written and its sender; and what waits until all that was noted is in the file."""
    monkeypatch.setattr(module, "GATHER", 0.0)
    history = History(path, HistorySettings(), clock=lambda: 10 * DAY)
    settings = HistoryDatabase(url="postgresql://nowhere/x", tls=False)
    sender = Forwarder(
        path, settings, lambda at: HistoryFile(at, create=False), lambda _: database, "entries"
    )
    writer = asyncio.create_task(history.run())

    async def written():
        async with asyncio.timeout(30):
            while history._waiting:  # noqa: ASYNC110 - another thread writes
                await asyncio.sleep(0.01)

    yield history, sender, written
    writer.cancel()
    await asyncio.wait({writer})
    await history.close()
    await sender.close()


async def test_rows_whose_answer_was_lost_are_sent_once_and_counted(path, monkeypatch):
    database = AnswersOnceTooLate()
    async with written_and_sent(path, database, monkeypatch) as (history, sender, written):
        for k in (1, 2):
            history.noted(entry(k))
        await written()
        with pytest.raises(StoreError):
            await sender._in_thread()
        assert sender.sent == 0
        assert await sender._in_thread() == 0
        assert sender.sent == 2
        assert list(database.kept.values()) == [[1, 2]]


def put_aside(path):
    path.rename(path.with_suffix(".1"))


@pytest.mark.parametrize("rotate", [Path.unlink, put_aside])
async def test_a_file_that_was_removed_is_begun_anew_and_sent_on(path, monkeypatch, caplog, rotate):
    database = NumbersByFile()
    async with written_and_sent(path, database, monkeypatch) as (history, sender, written):
        for k in (1, 2):
            history.noted(entry(k))
            await written()
        assert await sender._in_thread() == 2
        rotate(path)
        assert await sender._in_thread() == 0
        history.noted(entry(3))
        await written()
        assert await sender._in_thread() == 1
    assert opened(path, lambda file: file.read()) == (entry(3),)
    assert list(database.kept.values()) == [[1, 2], [1]]
    assert caplog.text.count("was removed or replaced; it is begun anew") == 1
