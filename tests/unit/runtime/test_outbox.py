import asyncio

import pytest

from agent.runtime.outbox import MemoryOutbox
from connectors.base import Publication


def state(number, subject="FIC101"):
    return Publication(subject, "state", f"s{number}", {"active": bool(number)})


def event(number):
    return Publication("FIC101", "event", f"e{number}", {})


async def drained(outbox):
    taken = []
    while len(outbox):
        taken.append(await outbox.first())
        outbox.remove(taken[-1])
    return [publication.id for publication in taken]


async def test_events_leave_in_the_order_they_came():
    outbox = MemoryOutbox()
    for k in range(3):
        outbox.put(event(k))
    assert await drained(outbox) == ["e0", "e1", "e2"]


async def test_a_state_replaces_the_former_of_the_same_loop_only():
    outbox = MemoryOutbox()
    for publication in (state(1), state(2, "LIC205"), event(1), state(3)):
        outbox.put(publication)
    assert await drained(outbox) == ["s2", "e1", "s3"]


async def test_what_is_not_removed_comes_again():
    outbox = MemoryOutbox()
    outbox.put(event(1))
    assert await outbox.first() is await outbox.first()


async def test_a_state_that_was_replaced_while_it_was_sent_stays():
    outbox = MemoryOutbox()
    outbox.put(state(1))
    sent = await outbox.first()
    outbox.put(state(2))
    outbox.remove(sent)
    assert await drained(outbox) == ["s2"]


async def test_it_is_bounded_and_counts_what_it_drops():
    outbox = MemoryOutbox(limit=3)
    for k in range(5):
        outbox.put(event(k))
    assert outbox.dropped == 2
    assert await drained(outbox) == ["e2", "e3", "e4"]


async def test_it_waits_while_there_is_nothing():
    outbox = MemoryOutbox()
    outbox.put(event(1))
    await drained(outbox)
    with pytest.raises(TimeoutError):
        async with asyncio.timeout(0.01):
            await outbox.first()
