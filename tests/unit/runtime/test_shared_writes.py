"""Many that wait for the store at once."""

import asyncio
import itertools
import threading
from contextlib import closing

from agent.runtime.link.outbox import Outbox
from agent.runtime.store.journal import Journal
from agent.runtime.store.store import Store
from connectors.base import Publication


async def test_those_that_wait_share_a_write_and_closing_waits_for_it(tmp_path, monkeypatch):
    path = tmp_path / "plant.sqlite"
    journal = Journal(path)
    await journal.open()
    outbox, looks, flushes = Outbox("broker", journal), itertools.count(), []
    all_wait = threading.Event()  # else how many share a write depends on how fast this machine writes
    monkeypatch.setattr(Store, "is_foreign", lambda _: not all_wait.wait(60) or next(looks) < 0)  # of a write
    for k in range(60):
        outbox.put(Publication("FIC101", "event", f"e{k}", {}))
        flushes.append(asyncio.create_task(journal.flush()))
        await asyncio.sleep(0)
        if k % 2:
            flushes[-1].cancel()
    all_wait.set()
    await journal.close()
    assert [each for each in asyncio.all_tasks() if each.get_name() == "store"] == []
    with closing(Store(path)) as store:
        assert len(store.read().waiting) == 60
    assert next(looks) < 10
    await asyncio.gather(*flushes, return_exceptions=True)
