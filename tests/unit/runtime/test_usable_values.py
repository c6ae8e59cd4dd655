"""A loop without a usable PV or OP is not healthy; a restarted peer gets the newest states again."""

import asyncio
import json
import logging
import os
import stat

import pytest

from agent.runtime.intake.usable import LOGGED_AGAIN, UsableValues
from agent.runtime.operate.health_json import health_text
from agent.runtime.store.history_file import HistoryFile
from agent.runtime.store.lock import only_agent_of
from agent.runtime.store.store import Store
from connectors.base import ConfigError, ConnectionLostError, LoopRole, Quality, Sample
from tests.unit.runtime.agents import agent_of, stream, virtual
from tests.unit.runtime.fake_bus import FakeBus
from tests.unit.runtime.loops import START, sample


def without_pv(seconds):
    """OP is fine, PV is refused by its server all the time."""

    def source(_session):
        for k in range(seconds):
            yield sample("op", k, 50.0 + k % 3)
            yield Sample.missing(LoopRole("FIC101", "pv"), START + k, 0x80340000, "BadNodeIdUnknown")
            yield 1.0

    return source


def test_a_loop_without_one_usable_pv_is_stale_unhealthy_and_logged_once(caplog):
    agent = agent_of(FakeBus(without_pv(300)))

    async def scenario():
        task = asyncio.create_task(agent.run())
        await asyncio.sleep(250.0)
        status = await agent.looked()
        text = await health_text(status)
        task.cancel()
        await asyncio.wait({task})
        return status, json.loads(text)

    with caplog.at_level(logging.WARNING):
        status, found = virtual(scenario())
    (loop,) = status.loops
    assert (loop.data, status.ok) == ("stale", False)
    assert found["status"] == "degraded"
    assert found["loops"]["FIC101"]["error"].endswith("BadNodeIdUnknown")
    assert found["loops"]["FIC101"]["error"].startswith("PV had no usable value for ")
    assert sum("FIC101: PV cannot be used: BadNodeIdUnknown" in each.message for each in caplog.records) == 1


def test_a_value_that_is_usable_again_ends_it_and_flapping_is_logged_seldom(caplog):
    values = UsableValues("FIC101")
    values.see(sample("op", 0, 1.0), 0.0)
    with caplog.at_level(logging.WARNING):
        for k in range(100):
            values.see(sample("pv", k, 1.0, Quality.BAD), float(k))
            assert "PV" in values.problem(k + 50.0, 0.0, 10.0)
            values.see(sample("pv", k, 1.0), k + 0.5)
            assert values.problem(k + 50.0, 0.0, 10.0) is None
        values.see(sample("pv", 0, 1.0, Quality.BAD), LOGGED_AGAIN + 1)
    assert len(caplog.records) == 2


def dies_after(seconds):
    """A bus with an oscillating loop whose first session ends; in the next ones nothing new comes."""

    def source(session):
        if session:
            yield 1000.0
        yield from stream(["FIC101"], seconds)(0)
        yield ConnectionLostError("restarted")

    return source


def test_a_peer_that_was_restarted_gets_the_newest_state_again_and_no_event_twice():
    bus = FakeBus(dies_after(430))
    agent = agent_of(bus)

    async def scenario():
        task = asyncio.create_task(agent.run())
        await asyncio.sleep(429.0)  # the alarm is there, and published
        before = list(bus.published)
        await asyncio.sleep(60.0)
        task.cancel()
        await asyncio.wait({task})
        return before

    before = virtual(scenario())
    assert len(bus.opened) == 2
    (again,) = bus.published[len(before) :]
    assert again == [each for each in before if each.kind == "state"][-1]
    assert [each.kind for each in before].count("event") == 1


def test_one_state_file_has_one_lock_whatever_the_way_to_it(tmp_path):
    state = tmp_path / "plant.sqlite"
    state.touch()
    other = tmp_path / "link.sqlite"
    other.symlink_to(state)
    used = pytest.raises(ConfigError, match="is used by another agent")
    with only_agent_of(state), used, only_agent_of(other):
        pytest.fail("two agents share a state file")


@pytest.mark.parametrize("kind", [Store, HistoryFile])
def test_a_new_file_is_for_its_owner_only(tmp_path, kind):
    before = os.umask(0o022)
    try:
        file = kind(tmp_path / "plant.sqlite")
        modes = {stat.S_IMODE(path.stat().st_mode) for path in tmp_path.iterdir()}
        file.close()
    finally:
        os.umask(before)
    assert modes == {0o600}
