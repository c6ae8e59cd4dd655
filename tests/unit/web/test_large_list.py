"""A list of many loops is made in slices."""

from agent.runtime.operate import breath
from agent.web.screens.work_list import Wanted, listed, map_of
from tests.other_turns import other_turns
from tests.unit.web.test_screens import large


async def test_others_have_their_turn_while_a_large_plant_is_listed(monkeypatch):
    """Each step over all loops is in slices: with slices of one loop, others come in between each two."""
    monkeypatch.setattr(breath, "AT_ONCE", 0.0)
    loops = 600
    look = await large(loops)
    async with other_turns() as turns:
        assert await turns.of(large(loops)) >= loops - 1
        assert await turns.of(listed(look, Wanted(search="FIC"))) >= loops - 1
        assert await turns.of(listed(look, Wanted(sort="s"))) >= loops - 1
        assert await turns.of(map_of(look)) >= loops - 1
