"""`slipjump alarms` beside an agent that runs, and beside one that doesn't."""

import asyncio
import contextlib
import json
import sys

import pytest

from agent.alarms import Alarm, Delay, State
from agent.cli import main
from agent.cli.common.stage import until
from agent.runtime.agent import Agent
from agent.runtime.loop.workers import InlineExecutor
from agent.runtime.store.change import Change
from agent.runtime.store.store import Store
from agent.settings import AgentSettings, ConnectionSettings, Settings
from connectors.options import Options, Target
from tests.unit.alarms.test_alarm import play
from tests.unit.runtime.fake_bus import FakeBus
from tests.unit.runtime.loops import loop_settings


@pytest.fixture
def path(tmp_path):
    """A store in which the alarm of FIC101 is active."""
    path = tmp_path / "plant.sqlite"
    alarm, _ = play(Alarm("FIC101", delay=Delay(1, 1)), ["stiction"])
    store = Store(path)
    store.write(Change({"FIC101": alarm}))
    store.close()
    return path


def slipjump(*words):
    """The exit code of a command."""
    with pytest.raises(SystemExit) as ended:
        main([str(word) for word in words])
    return ended.value.code


def listed(path, capsys):
    capsys.readouterr()
    assert slipjump("alarms", "list", "--state", path, "--json") == 0
    return [json.loads(line) for line in capsys.readouterr().out.splitlines()]


@contextlib.asynccontextmanager
async def agent_on(path):
    bus = FakeBus(lambda _: iter(()))
    settings = Settings(
        agent=AgentSettings(state=path),
        connections={"bus": ConnectionSettings("fake", Options())},
        loops=(loop_settings(publish=(Target(connection="bus"),)),),
    )
    agent = Agent(settings, InlineExecutor(), connectors=[bus])
    task = asyncio.create_task(agent.run())
    try:
        yield agent, bus
    finally:
        task.cancel()
        await asyncio.wait({task})


async def test_a_running_agent_obeys_within_a_second_and_reports_it(path, capsys):
    async with agent_on(path) as (agent, bus):
        words = ["alarms", "acknowledge", "FIC101", "--state", path, "--by", "jane"]
        assert await asyncio.to_thread(slipjump, *words) == 0
        assert agent.status()[0].alarm is State.ACKED_ACTIVE
        assert await until(lambda: not len(agent.outboxes["bus"]), 1.0)
    assert [(p.kind, p.fields["state"], p.fields["by"]) for p in bus.published[-2:]] == [
        ("state", "acked_active", "jane"),
        ("event", "acked_active", "jane"),
    ]
    assert "FIC101: acked_active, by jane" in capsys.readouterr().out


async def test_a_restart_neither_forgets_nor_repeats(path, capsys):
    events = []
    for command in (["shelve", "--hours", "1"], ["shelve", "--hours", "2"], ["list"], ["unshelve"]):
        async with agent_on(path) as (agent, bus):
            loop = [] if command == ["list"] else ["FIC101"]
            await asyncio.to_thread(slipjump, "alarms", *command, *loop, "--state", path)
            assert await until(lambda: not len(agent.outboxes["bus"]), 1.0)
        events += [p.fields["state"] for p in bus.published if p.kind == "event"]
        if command != ["unshelve"]:
            (fields,) = listed(path, capsys)
            assert (fields["state"], fields["id"]) == ("shelved", "FIC101/0.000000")
    assert events == ["shelved", "unacked_active"]


def test_without_an_agent_a_command_waits(path, capsys, monkeypatch):
    monkeypatch.setattr(sys.modules["agent.cli.alarms"], "TAKEN_WITHIN", 0.0)
    for command in ("acknowledge", "out-of-service", "return"):
        assert slipjump("alarms", command, "FIC101", "--state", path, "--by", "jane") == 0
        assert "when it starts" in capsys.readouterr().out
    assert listed(path, capsys)[0]["waits"] == ["acknowledge", "remove_from_service", "return_to_service"]
    assert slipjump("alarms", "list", "--state", path) == 0
    assert "waits for the agent: acknowledge" in capsys.readouterr().out


def test_the_configuration_names_the_file(path, capsys):
    config = path.with_suffix(".yaml")
    tags = "{pv: {topic: a}, op: {topic: b}}"
    config.write_text(
        f"connections: {{b: {{kind: mqtt}}}}\nloops: [{{name: FIC101, connection: b, ts: 1, tags: {tags}}}]\n"
    )
    assert slipjump("alarms", "list", "--config", config) == 0
    assert (
        "FIC101: unacked_active, priority medium, NE 107 maintenance_required, S 4" in capsys.readouterr().out
    )


@pytest.mark.parametrize(
    ("words", "fault"),
    [
        (["alarms", "list"], "name the agent's file"),
        (["alarms", "list", "--state", "nowhere.sqlite"], "nowhere.sqlite: is not there"),
    ],
)
def test_a_missing_file_is_reported_in_one_line(words, fault, capsys):
    assert slipjump(*words) == 2
    assert fault in capsys.readouterr().err


def test_a_command_that_changes_nothing_is_no_success(path, capsys):
    store = Store(path)
    store.write(Change({"FIC102": Alarm("FIC102")}))
    store.close()
    assert slipjump("alarms", "acknowledge", "FIC102", "--state", path, "--by", "jane") == 2
    assert "FIC102: its alarm is normal, which acknowledge does not change" in capsys.readouterr().err
    assert {each["loop"]: each["waits"] for each in listed(path, capsys)}["FIC102"] == []


def test_a_loop_that_is_not_there_is_reported_with_those_that_are(path, capsys):
    assert slipjump("alarms", "acknowledge", "FIC999", "--state", path) == 2
    assert "no loop is called FIC999 (there are: FIC101)" in capsys.readouterr().err
