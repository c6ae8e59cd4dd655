"""Work on all loops leaves the event loop to others, and finds the same."""

import random

import pytest

from agent.runtime.operate import breath
from agent.runtime.operate.breath import RUN, breathing, in_order
from tests.other_turns import other_turns


@pytest.mark.parametrize("count", [0, 1, RUN, 3 * RUN + 7])
async def test_things_are_in_the_order_of_sorted_also_where_keys_are_equal(count):
    chance = random.Random(60100)
    things = [(chance.randrange(50), k) for k in range(count)]
    assert await in_order(things, lambda each: each[0]) == sorted(things, key=lambda each: each[0])


async def test_others_have_their_turn_meanwhile(monkeypatch):
    monkeypatch.setattr(breath, "AT_ONCE", 0.0)

    async def breathed():
        assert [each async for each in breathing(range(20))] == list(range(20))

    async with other_turns() as turns:
        assert await turns.of(breathed()) >= 19
        assert await turns.of(in_order(range(2 * RUN, 0, -1), lambda each: each)) >= 2 * RUN
