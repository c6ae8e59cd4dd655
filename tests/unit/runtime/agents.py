"""Agents on buses that are not there, in virtual time."""

import asyncio
import math

import async_solipsism
import pytest

from agent.analysis.diagnosis import Diagnosis
from agent.analysis.results import Oscillation
from agent.runtime.agent import Agent
from agent.runtime.loop.workers import InlineExecutor
from agent.settings import AgentSettings, ConnectionSettings, Settings
from connectors.options import Options, Target
from tests.unit.runtime.loops import loop_settings, sample

FIVE = tuple(f"FIC10{k}" for k in range(1, 6))


def virtual(coroutine):
    """Run in virtual time."""
    with asyncio.Runner(loop_factory=async_solipsism.EventLoop) as runner:
        return runner.run(coroutine)


def swinging(loop, t):
    """PV and OP of a loop that oscillates with a period of 50 s."""
    return [
        sample("pv", t, 50 + 5 * math.sin(t / 8), loop=loop),
        sample("op", t, 50 - 5 * math.cos(t / 8), loop=loop),
    ]


def stream(loops, seconds, step=1.0):
    def source(session):
        for k in range(int(seconds)):
            for loop in loops:
                yield from swinging(loop, session * seconds + k)
            yield step

    return source


def judged(verdict="stiction"):
    def diagnose(window, _seen=None):
        return Diagnosis(
            loop=window.loop,
            verdict=verdict,
            confidence=1.0,
            cause="undecided",
            causes=(),
            stiction_class=None,
            oscillation=Oscillation(detected=True, period=50.0, regularity=9.0),
            quantification=None,
        )

    return diagnose


def agent_of(
    bus,
    loops=("FIC101",),
    diagnose=None,
    seen=None,
    executor=None,
    scada=None,
    longest_wait=3.0,
    **loop_options,
):
    buses = [bus] if scada is None else [bus, scada]
    options = {"seconds": 400.0, "hop": 0.25, "publish": (Target(connection=buses[-1].name),)} | loop_options
    settings = Settings(
        agent=AgentSettings(longest_wait=longest_wait, clock_error=None),
        connections={each.name: ConnectionSettings("fake", Options()) for each in buses},
        loops=tuple(loop_settings(name, **options) for name in loops),
    )
    return Agent(
        settings,
        executor or InlineExecutor(),
        None if seen is None else seen.append,
        connectors=buses,
        diagnose=diagnose or judged(),
    )


async def worked(agent, seconds):
    """Let the agent work for some time and end it; nothing may be left of it."""
    task = asyncio.create_task(agent.run())
    await asyncio.sleep(seconds)
    status = agent.status()
    assert not task.done()
    task.cancel()
    with pytest.raises(asyncio.CancelledError):
        await task
    assert asyncio.all_tasks() == {asyncio.current_task()}
    return status
