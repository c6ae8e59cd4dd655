"""What the interface says of loops that oscillate together."""

from tests.unit.runtime.loops import START
from tests.unit.web.test_screens import plant_of


async def test_groups_have_the_same_keys_before_and_after_the_first_look():
    async with plant_of() as (web, plant):
        before = (await web.get("/api/work-list/groups")).json()
        assert before == {"time": None, "left_out": None, "compared": [], "seconds": 0.0, "groups": []}
        await plant.agent.plant_wide.look()
        after = (await web.get("/api/work-list/groups")).json()
        assert after.keys() == before.keys()
        assert after["time"] == START + 60
