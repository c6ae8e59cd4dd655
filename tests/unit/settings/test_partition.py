"""Parts of a plant for several agents: each loop in exactly one, and none where it was when others come."""

from pathlib import Path

import pytest

from agent.settings import settings_of
from agent.settings.partition import Partition
from connectors.base import ConfigError

LOOPS = [f"FIC{k:03d}" for k in range(200)]


def plant(loops):
    tags = {role: {"topic": "t", "field": role} for role in ("pv", "op")}
    return settings_of(
        {
            "agent": {"state": "plant.sqlite"},
            "connections": {
                "bus": {"kind": "mqtt", "client": "slipjump"},
                "edge": {"kind": "sparkplug", "node": "edge"},
            },
            "loops": [{"name": name, "connection": "bus", "ts": 1.0, "tags": tags} for name in loops],
        }
    )


def test_each_loop_is_in_one_part_and_the_parts_are_about_equal():
    parts = [Partition(k, 5).of_settings(plant(LOOPS)) for k in range(1, 6)]
    names = [loop.name for part in parts for loop in part.loops]
    assert sorted(names) == LOOPS
    assert all(20 <= len(part.loops) <= 60 for part in parts)
    fewer = Partition(2, 5).of_settings(plant(LOOPS[::2]))
    assert {loop.name for loop in fewer.loops} <= {loop.name for loop in parts[1].loops}


def test_a_part_has_a_state_file_and_a_name_on_the_broker_of_its_own():
    part = Partition.parse("2/5").of_settings(plant(LOOPS))
    assert part.agent.state == Path("plant.2of5.sqlite")
    assert list(part.connections) == ["bus"]  # nothing is read or published on the other one
    assert part.connections["bus"].options.client == "slipjump-2"


@pytest.mark.parametrize("text", ["0/5", "6/5", "2", "a/b", "-1/5", "2/5/1"])
def test_what_is_no_part_is_refused(text):
    with pytest.raises(ConfigError, match="expected part/parts"):
        Partition.parse(text)
    with pytest.raises(ConfigError, match="has no loop"):
        Partition(1 if Partition(2, 2).has("FIC001") else 2, 2).of_settings(plant(["FIC001"]))
