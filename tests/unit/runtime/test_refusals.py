"""What a peer refuses stays in the store until it is taken, and leaves nothing behind then."""

from agent.runtime.link import refusals
from agent.runtime.link.outbox import Outbox
from agent.runtime.store.journal import Journal
from connectors.base import RefusedError
from tests.unit.runtime.test_outbox import event, state

NO = RefusedError("BadNotWritable")


async def refused(outbox, publication):
    outbox.put(publication)
    outbox.refused(await outbox.first(), NO)


async def restarted(path):
    """An outbox after a kill, with what the store kept for it."""
    journal = Journal(path)
    kept = await journal.open()
    outbox = Outbox("bus", journal)
    outbox.restore({number: each.publication for number, each in kept.waiting.items()})
    return journal, outbox


async def in_store(journal):
    await journal.flush()
    return [each.publication.id for each in (await journal.open()).waiting.values()]


async def test_what_was_refused_is_reported_after_a_kill(tmp_path):
    journal, outbox = await restarted(tmp_path / "plant.sqlite")
    for publication in (event(1), state(1), event(2), state(2), state(1, "LIC205")):
        await refused(outbox, publication)
    outbox.put(state(3))
    assert (len(outbox), len(outbox.refusals), outbox.refusals.count) == (1, 4, 5)
    assert await in_store(journal) == ["e1", "e2", "s2", "s1", "s3"]  # of FIC101: refused, and newer
    await journal.close()

    journal, outbox = await restarted(tmp_path / "plant.sqlite")
    assert (len(outbox), len(outbox.refusals)) == (4, 0)
    told = []
    while len(outbox):
        told.append(await outbox.first())
        outbox.taken(told[-1])
    assert [(each.id, each.fields["historical"]) for each in told] == [
        ("e1", True),
        ("e2", True),
        ("s1", False),
        ("s3", False),
    ]
    assert await in_store(journal) == []
    await journal.close()


async def test_what_is_taken_at_last_leaves_the_store(tmp_path):
    journal, outbox = await restarted(tmp_path / "plant.sqlite")
    await refused(outbox, event(1))
    await refused(outbox, state(1))
    again = outbox.refusals.next()
    outbox.refused(again, NO)
    assert outbox.refusals.count == 3
    outbox.put(state(2))
    outbox.taken(await outbox.first())  # the newer state makes the refused one needless
    assert await in_store(journal) == ["e1"]
    outbox.taken(again)
    assert (await in_store(journal), outbox.oldest) == ([], None)
    await journal.close()


async def test_they_are_bounded_in_memory_and_in_the_store(tmp_path, monkeypatch):
    monkeypatch.setattr(refusals, "LIMIT", 5)
    journal, outbox = await restarted(tmp_path / "plant.sqlite")
    for k in range(1, 8):
        await refused(outbox, event(k))
    assert (len(outbox.refusals), outbox.refusals.dropped) == (5, 2)
    assert await in_store(journal) == ["e3", "e4", "e5", "e6", "e7"]
    await journal.close()


async def test_the_oldest_of_all_that_waits_is_known():
    now = iter([1000.0, 2000.0, 3000.0])
    outbox = Outbox("bus", Journal(clock=lambda: next(now)))
    assert outbox.oldest is None
    await refused(outbox, event(1))
    outbox.put(event(2))
    assert outbox.oldest == 1000.0
    outbox.taken(outbox.refusals.next())
    assert outbox.oldest == 2000.0
