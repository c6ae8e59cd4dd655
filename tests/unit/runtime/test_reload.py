"""Other settings while it runs: what they leave as it is goes on as if nothing had happened."""

import asyncio
import logging

import pytest

from agent.alarms import Alarm, Delay, State
from agent.runtime.agent import Agent
from agent.runtime.loop.workers import InlineExecutor
from agent.runtime.operate.plan import difference
from agent.settings import AgentSettings, AlarmSettings, ConnectionSettings, Settings, settings_of
from connectors.base import WITHDRAWN, ConfigError, ConnectionLostError
from connectors.options import Options, Target
from tests.unit.runtime.agents import judged, stream, virtual
from tests.unit.runtime.fake_bus import FakeBus
from tests.unit.runtime.loops import loop_settings


class Other(Options):
    """Options of a fake bus."""

    port: int = 1


def plant(*loops, agent=None, **connections):
    """Settings with the loops (name, connection, other keys) on connections (name=options)."""
    return Settings(
        agent or AgentSettings(clock_error=None),
        {name: ConnectionSettings("fake", options) for name, options in connections.items()},
        tuple(
            loop_settings(
                name,
                connection=bus,
                **{"seconds": 400.0, "hop": 0.25, "quantify": "always", "publish": (Target(connection=bus),)}
                | keys,
            )
            for name, bus, keys in loops
        ),
    )


def bus(name, *loops):
    return FakeBus(stream(loops, 5000), name)


A1, A2, B1 = ("A1", "a", {}), ("A2", "a", {}), ("B1", "b", {})
BEFORE = plant(A1, A2, B1, a=Other(), b=Other())


async def reloaded(before, after, buses, after_buses, settle=500.25, **others):
    """Run ``before`` for some time, then ``after``; return agent, and status before and after."""
    agent = Agent(before, InlineExecutor(), connectors=buses, diagnose=judged(), **others)
    task = asyncio.create_task(agent.run())
    await asyncio.sleep(settle)
    first = {each.loop: each for each in agent.status()}
    await agent.reload(after, connectors=after_buses)
    await asyncio.sleep(3.5)
    second = await agent.looked()
    task.cancel()
    await asyncio.wait({task})
    assert asyncio.all_tasks() == {asyncio.current_task()}
    return agent, first, {each.loop: each for each in second.loops}, second


def test_a_loop_more_on_another_connection_disturbs_nobody(caplog):
    after = plant(A1, A2, B1, ("C1", "c", {}), a=Other(), b=Other(), c=Other())
    buses = [bus("a", "A1", "A2"), bus("b", "B1")]
    with caplog.at_level(logging.INFO):
        _, first, second, _ = virtual(
            reloaded(BEFORE, after, buses, [bus("a"), bus("b"), third := bus("c", "C1")])
        )
    assert [len(each.opened) for each in (*buses, third)] == [1, 1, 1]
    for loop in ("A1", "A2", "B1"):
        assert second[loop].samples == first[loop].samples + 6  # PV and OP, each second
        assert (second[loop].gaps, second[loop].alarm) == (0, State.UNACKED_ACTIVE)
    assert (second["C1"].samples, second["C1"].alarm) == (8, State.NORMAL)
    assert list(second) == ["A1", "A2", "B1", "C1"]
    assert "1 of 4 loops and 1 of 3 connections are new or changed" in caplog.text
    assert "is down" not in caplog.text


def test_a_connection_that_changed_is_opened_anew_and_its_loops_keep_their_windows():
    after = plant(A1, A2, B1, a=Other(port=2), b=Other())
    old, new, other = bus("a", "A1", "A2"), bus("a", "A1", "A2"), bus("b", "B1")
    new.opened.append(0.0)  # it plays on where the former one was, with a source time that goes on
    new.source = lambda _: stream(["A1", "A2"], 600)(1)
    old.source = lambda n: [ConnectionLostError("reset")] if n == 0 else stream(["A1", "A2"], 5000)(0)
    old.malformed, new.malformed = 3, 4
    _, first, second, overview = virtual(reloaded(BEFORE, after, [old, other], [new, bus("b")]))
    assert (old.open, len(other.opened)) == (0, 1)
    assert second["A1"].samples == first["A1"].samples + 8
    assert second["B1"].samples == first["B1"].samples + 6
    assert second["A1"].gaps == 99  # the window goes on, and what nobody heard is a gap in it
    assert [(each.losses, each.malformed) for each in overview.connections] == [(1, 7), (0, 0)]


def test_a_loop_that_went_leaves_no_task_and_its_alarm_is_there_when_it_comes_back():
    buses, scada = [bus("a", "A1", "A2"), bus("b", "B1")], plant(A1, A2, a=Other())

    async def scenario():
        agent = Agent(BEFORE, InlineExecutor(), connectors=buses, diagnose=judged())
        task = asyncio.create_task(agent.run())
        await asyncio.sleep(500.0)
        before = agent.status()[2].alarm
        await agent.reload(scada, connectors=[bus("a")])
        assert [p.kind for p in buses[1].published if p.subject == "B1"][-1] == WITHDRAWN
        assert WITHDRAWN not in {p.kind for p in buses[0].published}
        names = {each.get_name() for each in asyncio.all_tasks()}
        assert not [name for name in names if "B1" in name or name.endswith(" b")]
        assert ([each.loop for each in agent.status()], list(agent.outboxes)) == (["A1", "A2"], ["a"])
        assert buses[1].open == 0
        await agent.reload(BEFORE, connectors=[bus("a"), bus("b", "B1")])
        await asyncio.sleep(10.0)
        after = agent.status()[2]
        task.cancel()
        await asyncio.wait({task})
        return before, after

    before, after = virtual(scenario())
    assert before is after.alarm is State.UNACKED_ACTIVE
    assert after.samples == 20


@pytest.mark.parametrize(
    ("keys", "kept"),
    [
        ({"alarm": AlarmSettings(on_delay=2, off_delay=1, priority="high")}, True),
        ({"publish": ()}, True),
        ({"ts": 2.0}, False),
        ({"acting": "reverse"}, False),
    ],
)
def test_of_a_loop_that_changed_the_alarm_stays_and_the_window_if_it_is_cut_alike(keys, kept):
    after = plant(("A1", "a", keys), A2, B1, a=Other(), b=Other())
    again = bus("a", "A1", "A2")
    agent, first, second, _ = virtual(
        reloaded(BEFORE, after, [bus("a", "A1", "A2"), bus("b", "B1")], [again, bus("b")])
    )
    assert (second["A1"].samples >= first["A1"].samples) is kept
    assert second["A1"].alarm is State.UNACKED_ACTIVE
    assert agent._pipelines["A1"].alarm.priority == ("high" if "alarm" in keys else "medium")


def test_what_waits_for_a_connection_that_went_is_discarded_and_logged(tmp_path, caplog):
    """Virtual time knows no threads, so this one takes real time."""
    agent_settings = AgentSettings(clock_error=None, state=tmp_path / "plant.sqlite", history=None)
    scada = FakeBus(None, "scada")
    scada.refuses_connection = True
    loop = ("A1", "a", {"publish": (Target(connection="scada"),)})
    before = plant(loop, a=Other(), scada=Other(), agent=agent_settings)
    after = plant(("A1", "a", {"publish": ()}), a=Other(), agent=agent_settings)

    async def scenario():
        agent = Agent(before, InlineExecutor(), connectors=[bus("a"), scada])
        ready = asyncio.Event()
        task = asyncio.create_task(agent.run(ready.set))
        await ready.wait()
        agent._pipelines["A1"]._announce(next(iter(announcements())))
        await agent.journal.flush()
        assert len((await agent.journal.open()).waiting) == 1
        await agent.reload(after, connectors=[bus("a")])
        kept = await agent.journal.open()
        task.cancel()
        await asyncio.wait({task})
        return kept.waiting

    assert asyncio.run(scenario()) == {}
    assert "connection scada is no longer configured: A1/" in caplog.text


def announcements():
    return Alarm("A1", delay=Delay(1, 1)).on_diagnosis(judged()(type("W", (), {"loop": "A1"})), 1.0)[1]


def test_settings_that_cannot_be_change_nothing():
    raw = {
        "connections": {"a": {"kind": "mqtt", "port": 0}},
        "loops": [{"name": "A1", "connection": "a", "ts": 1, "tags": {}}],
    }
    with pytest.raises(ConfigError):
        settings_of(raw)


def test_a_fault_half_way_ends_the_agent_rather_than_a_loop_in_silence():
    after = plant(A1, A2, ("B1", "b", {"ts": 2.0}), a=Other(), b=Other())

    async def scenario():
        agent = Agent(BEFORE, InlineExecutor(), connectors=[bus("a", "A1", "A2"), bus("b", "B1")])
        task = asyncio.create_task(agent.run())
        await asyncio.sleep(10.0)
        agent._wiring._pipeline = lambda *_: 1 / 0
        with pytest.raises(ZeroDivisionError):
            await agent.reload(after, connectors=[bus("a"), bus("b", "B1")])
        with pytest.raises(ExceptionGroup) as ended:
            await task
        return ended.value

    assert virtual(scenario()).subgroup(ZeroDivisionError) is not None


def test_what_takes_effect_at_the_next_start_only_is_logged(caplog):
    after = plant(
        A1, A2, B1, a=Other(), b=Other(), agent=AgentSettings(clock_error=None, workers=3, watch_config=True)
    )
    buses = [bus("a", "A1", "A2"), bus("b", "B1")]
    agent, *_ = virtual(reloaded(BEFORE, after, buses, [bus("a"), bus("b")], settle=10.0))
    assert agent.settings.agent.workers == 1
    assert [r.message for r in caplog.records] == [
        "agent.workers takes effect at the next start of the agent",
        "agent.watch_config takes effect at the next start of the agent",
    ]


def test_the_difference_names_what_it_concerns():
    assert difference(BEFORE, BEFORE) == difference(BEFORE, plant(A1, A2, B1, a=Other(), b=Other()))
    assert not difference(BEFORE, BEFORE).connections
    turned = difference(BEFORE, plant(A2, A1, B1, a=Other(), b=Other()))
    assert (turned.loops, turned.connections) == (frozenset(), {"a"})  # the order may decide addresses
    patient = difference(
        BEFORE, plant(A1, A2, B1, a=Other(), b=Other(), agent=AgentSettings(clock_error=None, data_age=90))
    )
    assert (patient.loops, patient.connections) == (frozenset(), {"a", "b"})
