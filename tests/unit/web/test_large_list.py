"""A list of many loops is made in slices."""

import asyncio

from agent.runtime.operate import breath
from agent.web.screens.work_list import Wanted, listed, map_of
from tests.unit.web.test_screens import large


async def test_others_have_their_turn_while_a_large_plant_is_listed(monkeypatch):
    """Each step over all loops is in slices: with slices of one loop, others come in between each two."""
    monkeypatch.setattr(breath, "AT_ONCE", 0.0)
    turns = 0

    async def other():
        nonlocal turns
        while True:
            turns += 1
            await asyncio.sleep(0)

    async def turns_of(work):
        nonlocal turns
        turns = 0
        await work
        return turns

    task = asyncio.create_task(other())
    loops = 600
    look = await large(loops)
    assert await turns_of(large(loops)) >= loops - 1
    assert await turns_of(listed(look, Wanted(search="FIC"))) >= loops - 1
    assert await turns_of(listed(look, Wanted(sort="s"))) >= loops - 1
    assert await turns_of(map_of(look)) >= loops - 1
    task.cancel()
