import asyncio

import pytest

from agent.runtime.link.outbox import Outbox
from agent.runtime.store.journal import Journal
from connectors.base import Publication


def state(number, subject="FIC101"):
    return Publication(subject, "state", f"s{number}", {"active": bool(number)})


def event(number):
    return Publication("FIC101", "event", f"e{number}", {})


async def drained(outbox):
    taken = []
    while len(outbox):
        taken.append(await outbox.first())
        outbox.taken(taken[-1])
    return [publication.id for publication in taken]


async def test_events_leave_in_the_order_they_came():
    outbox = Outbox("bus", Journal())
    for k in range(3):
        outbox.put(event(k))
    assert await drained(outbox) == ["e0", "e1", "e2"]


async def test_a_state_replaces_the_former_of_the_same_loop_only():
    outbox = Outbox("bus", Journal())
    for publication in (state(1), state(2, "LIC205"), event(1), state(3)):
        outbox.put(publication)
    assert await drained(outbox) == ["s2", "e1", "s3"]


async def test_what_is_not_removed_comes_again():
    outbox = Outbox("bus", Journal())
    outbox.put(event(1))
    assert await outbox.first() == await outbox.first()


async def test_a_state_that_was_replaced_while_it_was_sent_stays():
    outbox = Outbox("bus", Journal())
    outbox.put(state(1))
    sent = await outbox.first()
    outbox.put(state(2))
    outbox.taken(sent)
    assert await drained(outbox) == ["s2"]


async def test_it_is_bounded_and_counts_what_it_drops():
    outbox = Outbox("bus", Journal(), limit=3)
    for k in range(5):
        outbox.put(event(k))
    assert outbox.dropped == 2
    assert await drained(outbox) == ["e2", "e3", "e4"]


async def test_it_waits_while_there_is_nothing():
    outbox = Outbox("bus", Journal())
    outbox.put(event(1))
    await drained(outbox)
    with pytest.raises(TimeoutError):
        async with asyncio.timeout(0.01):
            await outbox.first()


async def test_of_too_many_the_oldest_state_goes_before_any_event(caplog):
    outbox = Outbox("bus", Journal(), limit=3)
    for publication in (event(1), state(1), state(2, "LIC205"), event(2), event(3)):
        outbox.put(publication)
    assert await drained(outbox) == ["e1", "e2", "e3"]
    assert outbox.dropped == 2
    assert not caplog.records
    for k in range(4):
        outbox.put(event(k))
    assert "outbox full: e0 was discarded" in caplog.text


async def test_only_an_event_that_came_or_waited_without_a_connection_is_historical():
    outbox = Outbox("bus", Journal())
    outbox.put(event(1))  # before the first connection
    told = [await outbox.first()]
    outbox.taken(told[-1])
    for publication in (event(2), event(3), state(1)):
        outbox.put(publication)
    told.append(await outbox.first())
    outbox.taken(told[-1])
    outbox.interrupt()
    while len(outbox):
        told.append(await outbox.first())
        outbox.taken(told[-1])
    assert [(each.id, each.fields["historical"]) for each in told] == [
        ("e1", True),
        ("e2", False),
        ("e3", True),
        ("s1", False),
    ]


async def test_the_sequence_rises_also_where_the_clock_is_set_back():
    now = iter([1000.0, 10.0, 2000.0])
    outbox = Outbox("bus", Journal(clock=lambda: next(now)))
    sequences = []
    for k in range(3):
        outbox.put(event(k))
        sent = await outbox.first()
        sequences.append(sent.fields["sequence"])
        outbox.taken(sent)
    assert sequences == [1_000_000, 1_000_001, 2_000_000]
