"""Configure: a loop is checked, tried on a live bus, saved, and applied while the others go on."""

import asyncio
import errno
import math
from contextlib import asynccontextmanager

import yaml

from agent.runtime.agent import Agent
from agent.runtime.loop.workers import InlineExecutor
from agent.settings import HttpSettings
from agent.settings.load import load_settings
from agent.web.access import Access
from agent.web.app import application
from agent.web.configuration import Configuration
from agent.web.screens import configure
from simulators.plant import Row
from simulators.servers.modbus import ModbusServer
from tests.unit.web.clients import client, csrf

ROLES = ("pv", "op")


@asynccontextmanager
async def plant(folder):
    """A running agent with one loop of a live device that has two, and a client of its page."""
    async with ModbusServer({"FIC101": ROLES, "FIC102": ROLES}) as server:
        for loop, value in (("FIC101", 50.0), ("FIC102", 20.0)):
            await server.put(loop, Row(1.7e9, {"pv": value, "op": 40.0}))
        path = folder / "plant.yaml"
        loop = {**server.loop_settings("FIC101", 1.0), "name": "FIC101"}
        content = {"connections": {"modbus": server.connection_settings()}, "loops": [loop]}
        path.write_text("# ours\n" + yaml.safe_dump(content))
        path.chmod(0o640)
        agent = Agent(load_settings(path), InlineExecutor())
        ready = asyncio.Event()
        work = asyncio.create_task(agent.run(ready.set))
        try:
            await ready.wait()
            app = application([configure.screen(Configuration(path, agent))], Access())
            async with client(app) as web:
                yield path, agent, server, web, await csrf(web)
        finally:
            work.cancel()
            await asyncio.wait({work})


def new_loop(server):
    return {**server.loop_settings("FIC102", 1.0), "name": "FIC102", "publish": [], "op_range": None}


async def test_a_loop_is_tried_on_the_bus_saved_and_watched(tmp_path):
    async with plant(tmp_path) as (path, agent, server, web, head):
        page = (await web.get("/api/configure")).json()
        assert [each["name"] for each in page["loops"]] == ["FIC101"]
        assert page["kinds"]["modbus"]["required"] == ["table", "address"]
        held = agent.pipelines["FIC101"]
        wish = {"what": "loop", "name": "FIC102", "entry": new_loop(server)}
        found = (await web.post("/api/configure/check", json=wish, headers=head)).json()
        assert found["faults"] == []
        assert all(line[0] in "+ @" for line in found["difference"].splitlines())
        tried = (await web.post("/api/configure/try", json=wish, headers=head)).json()["findings"]
        assert {each["role"]: each["value"] for each in tried} == {"": None, "pv": 20.0, "op": 40.0}
        before = path.read_text()
        assert list(agent.pipelines) == ["FIC101"]
        saving = wish | {"digest": found["digest"], "by": "jane"}
        assert (await web.post("/api/configure/save", json=saving, headers=head)).status_code == 200
        assert list(agent.pipelines) == ["FIC101", "FIC102"]
        assert agent.pipelines["FIC101"] is held  # its window goes on
        assert path.read_text().startswith(before.rstrip("\n"))
        assert path.stat().st_mode & 0o777 == 0o640
        assert [each.name for each in tmp_path.iterdir() if each.name.startswith(".plant")] == []


async def test_all_faults_are_shown_and_nothing_is_written(tmp_path):
    async with plant(tmp_path) as (path, _, server, web, head):
        before = path.read_text()
        wrong = new_loop(server) | {"ts": -1, "connection": "nowhere"}
        wish = {"what": "loop", "name": "FIC102", "entry": wrong}
        found = (await web.post("/api/configure/check", json=wish, headers=head)).json()
        assert any("nowhere" in fault for fault in found["faults"])
        saving = wish | {"digest": found["digest"], "by": "jane"}
        assert (await web.post("/api/configure/try", json=wish, headers=head)).status_code == 422
        assert (await web.post("/api/configure/save", json=saving, headers=head)).status_code == 409
        bad = {"what": "loop", "name": "X", "yaml": "name: [unclosed"}
        assert (await web.post("/api/configure/check", json=bad, headers=head)).json()["faults"]
        assert path.read_text() == before


async def test_a_file_that_somebody_else_changed_is_not_overwritten(tmp_path):
    async with plant(tmp_path) as (path, agent, server, web, head):
        wish = {"what": "loop", "name": "FIC102", "entry": new_loop(server)}
        found = (await web.post("/api/configure/check", json=wish, headers=head)).json()
        path.write_text(path.read_text() + "# by hand\n")
        saving = wish | {"digest": found["digest"], "by": "jane"}
        answer = await web.post("/api/configure/save", json=saving, headers=head)
        assert (answer.status_code, "changed" in answer.json()["detail"]) == (409, True)
        assert list(agent.pipelines) == ["FIC101"]


async def test_a_value_that_is_missing_on_the_bus_is_said(tmp_path, monkeypatch):
    monkeypatch.setattr("agent.web.configuration.PROBED", 2.0)
    async with plant(tmp_path) as (_, _, server, web, head):
        await server.put("FIC102", Row(math.nan, {}))
        entry = new_loop(server)
        entry["tags"]["pv"] = {"table": "holding", "address": 4000}
        wish = {"what": "loop", "name": "FIC102", "entry": entry}
        tried = (await web.post("/api/configure/try", json=wish, headers=head)).json()["findings"]
        assert [each["role"] for each in tried if each["problems"]] == ["pv", "op"]


async def test_a_disk_that_is_full_is_said_and_the_file_stays(tmp_path, monkeypatch):
    def full(**_):
        raise OSError(errno.ENOSPC, "No space left on device")

    async with plant(tmp_path) as (path, agent, server, web, head):
        before = path.read_text()
        wish = {"what": "loop", "name": "FIC102", "entry": new_loop(server)}
        found = (await web.post("/api/configure/check", json=wish, headers=head)).json()
        monkeypatch.setattr("agent.web.configuration.tempfile.mkstemp", full)
        saving = wish | {"digest": found["digest"], "by": "jane"}
        answer = await web.post("/api/configure/save", json=saving, headers=head)
        assert (answer.status_code, "No space left" in answer.json()["detail"]) == (500, True)
        assert (path.read_text(), list(agent.pipelines)) == (before, ["FIC101"])


def test_the_page_changes_no_file_unless_the_file_says_so():
    assert HttpSettings().configure is False


async def test_text_that_nobody_can_read_is_a_fault_and_no_more(tmp_path):
    async with plant(tmp_path) as (_, _, _, web, head):
        for text, words in (("[" * 3000, "nested too deeply"), ("name: F1\nts: 2024-13-45", "month must be")):
            wish = {"what": "loop", "name": "F1", "yaml": text}
            answer = await web.post("/api/configure/check", json=wish, headers=head)
            assert answer.status_code == 200, answer.text
            assert words in answer.json()["faults"][0]
