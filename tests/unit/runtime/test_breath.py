"""Work on all loops leaves the event loop to others, and finds the same."""

import asyncio
import random

import pytest

from agent.runtime.operate import breath
from agent.runtime.operate.breath import RUN, breathing, in_order


@pytest.mark.parametrize("count", [0, 1, RUN, 3 * RUN + 7])
async def test_things_are_in_the_order_of_sorted_also_where_keys_are_equal(count):
    chance = random.Random(60100)
    things = [(chance.randrange(50), k) for k in range(count)]
    assert await in_order(things, lambda each: each[0]) == sorted(things, key=lambda each: each[0])


async def test_others_have_their_turn_meanwhile(monkeypatch):
    monkeypatch.setattr(breath, "AT_ONCE", 0.0)
    turns = 0

    async def other():
        nonlocal turns
        while True:
            turns += 1
            await asyncio.sleep(0)

    task = asyncio.create_task(other())
    assert [each async for each in breathing(range(20))] == list(range(20))
    of_breathing, turns = turns, 0
    await in_order(range(2 * RUN, 0, -1), lambda each: each)
    task.cancel()
    assert of_breathing >= 19
    assert turns >= 2 * RUN
