"""The file of a running agent: when it is read anew, and what becomes of a faulty one."""

import asyncio

import pytest
import yaml

from agent.runtime.operate import reload as module
from agent.runtime.operate.notify import ServiceManager
from agent.runtime.operate.reload import Reloader
from agent.settings import load_settings

LOOP = {"name": "FIC101", "connection": "b", "ts": 1, "tags": {"pv": {"topic": "p"}, "op": {"topic": "o"}}}


class FakeAgent:
    """Takes over settings, and remembers them."""

    summary = ""

    def __init__(self, settings):
        self.settings = settings
        self.taken = []

    async def reload(self, settings):
        self.settings = settings
        self.taken.append([loop.name for loop in settings.loops])


@pytest.fixture
def path(tmp_path):
    path = tmp_path / "plant.yaml"
    write(path, LOOP)
    return path


def write(path, *loops, watch=True):
    content = {"agent": {"watch_config": watch}, "connections": {"b": {"kind": "mqtt"}}, "loops": list(loops)}
    path.write_text(yaml.safe_dump(content))


async def played(path, scenario, monkeypatch):
    """Run a reloader with quick looks, and a scenario of it, its agent and the event that asks."""
    monkeypatch.setattr(module, "LOOK", 0.02)
    agent, asked = FakeAgent(load_settings(path)), asyncio.Event()
    reloader = Reloader(path, agent, ServiceManager(), asked)
    task = asyncio.create_task(reloader.run())
    try:
        await scenario(reloader, agent, asked)
    finally:
        task.cancel()
        await asyncio.wait({task})


async def until(condition):
    async with asyncio.timeout(30):
        while not condition():  # noqa: ASYNC110 - a state of the reloader is no event
            await asyncio.sleep(0.005)


async def test_a_change_is_taken_and_a_fault_is_not_until_it_is_mended(path, monkeypatch, caplog):
    async def scenario(reloader, agent, _):
        path.write_text("loops: [")
        await until(lambda: reloader.refused == 1)
        await asyncio.sleep(0.2)
        assert (reloader.refused, agent.taken) == (1, [])  # told once, not at each look
        write(path, LOOP, LOOP | {"name": "FIC102"})
        await until(lambda: agent.taken)
        assert agent.taken == [["FIC101", "FIC102"]]

    await played(path, scenario, monkeypatch)
    assert "the agent continues with its previous settings" in caplog.text


async def test_a_list_of_loops_is_watched_like_the_file_itself(path, monkeypatch):
    listed = path.with_name("loops.csv")
    listed.write_text("name,connection,ts,pv,op\nLIC1,b,1,p,o\n")
    write(path, LOOP, {"from": "loops.csv"})

    async def scenario(_, agent, __):
        assert agent.settings.lists == (listed,)
        listed.write_text("name,connection,ts,pv,op\nLIC1,b,1,p,o\nLIC2,b,1,p,o\n")
        await until(lambda: agent.taken)
        assert agent.taken == [["FIC101", "LIC1", "LIC2"]]

    await played(path, scenario, monkeypatch)


async def test_a_file_that_is_not_there_for_a_moment_is_waited_for(path, monkeypatch):
    async def scenario(reloader, agent, _):
        path.unlink()
        await asyncio.sleep(0.2)
        assert (reloader.refused, agent.taken) == (0, [])
        write(path, LOOP | {"name": "FIC103"})
        await until(lambda: agent.taken)

    await played(path, scenario, monkeypatch)


async def test_without_leave_only_who_requests_gets_it(path, monkeypatch):
    write(path, LOOP, watch=False)

    async def scenario(_, agent, asked):
        write(path, LOOP | {"name": "FIC104"}, watch=False)
        await asyncio.sleep(0.2)
        assert agent.taken == []
        asked.set()
        await until(lambda: agent.taken)

    await played(path, scenario, monkeypatch)
