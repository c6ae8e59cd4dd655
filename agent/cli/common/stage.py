"""Plants or recordings on real buses, the agent that reads them, and consumers that watch its alarms."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Callable, Mapping, Sequence
from contextlib import AsyncExitStack, asynccontextmanager
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from agent.runtime.agent import Agent
from agent.settings import settings_of
from connectors.cancellation import obey_cancellation
from simulators.clock import Clock
from simulators.player import play
from simulators.servers.broker import embedded_broker
from simulators.servers.loop_server import LoopServer, roles_of
from simulators.servers.modbus import ModbusServer
from simulators.servers.mqtt import MqttServer
from simulators.servers.opcua import OpcUaServer

if TYPE_CHECKING:
    from agent.analysis.diagnosis import Diagnosis
    from agent.runtime.loop.workers import Executor
    from simulators.source import Source

BUSES = ("modbus", "opcua", "mqtt")
LOOK = 0.02
"""Time between two looks at a condition, s."""


@dataclass(slots=True)
class LivePlay:
    """What happens while the curtain is up."""

    agent: Agent
    playing: asyncio.Future[Any]
    """Done when every source has been played to its end."""
    clocks: Sequence[Clock] = ()
    """What paces the sources, one a bus."""
    told: dict[str, bool] = field(default_factory=dict)
    """Loop -> whether a consumer on its bus received that its alarm is active; the newest."""


@asynccontextmanager
async def on_stage(
    sources: Mapping[str, Sequence[Source]],
    loop_options: Callable[[Source], Mapping[str, Any]],
    speed: float | None,
    executor: Executor,
    on_diagnosis: Callable[[Diagnosis], None],
    accompany: Callable[[Agent], None] | None = None,
) -> AsyncIterator[LivePlay]:
    """Play sources on their buses to an agent, with an independent consumer on each bus.

    Args:
        sources: Bus -> what is played there.
        loop_options: Keys of the configuration's loop entry beside its tags, for each source.
        speed: Times real time; None: as fast as the reader takes it.
        executor: Where diagnoses run.
        on_diagnosis: Called with each diagnosis.
        accompany: Called with the agent before it starts.

    Raises:
        OSError: A port cannot be had; one line with host and port.
    """
    async with AsyncExitStack() as stack:
        servers = {
            bus: await stack.enter_async_context(await _server(bus, roles_of(loops), stack))
            for bus, loops in sources.items()
        }
        entries = [
            {**servers[bus].loop_settings(source.loop, source.ts), **loop_options(source)}
            for bus, loops in sources.items()
            for source in loops
        ]
        connections = {server.name: server.connection_settings() for server in servers.values()}
        settings = settings_of(
            {
                "agent": {"clock_error": None},  # plants and recordings have a time of their own
                "connections": connections,
                "loops": entries,
            }
        )
        agent = Agent(settings, executor, on_diagnosis)
        if accompany is not None:
            accompany(agent)
        tasks = await stack.enter_async_context(asyncio.TaskGroup())
        clocks = {bus: Clock(speed) for bus in sources}
        playing = tasks.create_task(_play(sources, servers, clocks, agent), name="players")
        stage = LivePlay(agent, playing, tuple(clocks.values()))
        background = [tasks.create_task(agent.run(), name="agent"), playing]
        background += [
            tasks.create_task(_watch(server, stage.told), name=f"consumer on {bus}")
            for bus, server in servers.items()
        ]
        try:
            yield stage
        finally:
            for task in background:
                task.cancel()


async def until(condition: Callable[[], bool], seconds: float) -> bool:
    """Wait until a condition holds, at most so many seconds; return whether it does."""
    clock = asyncio.get_running_loop()
    deadline = clock.time() + seconds
    while not condition():
        if clock.time() > deadline:
            return False
        await asyncio.sleep(LOOK)
    return True


async def _server(bus: str, roles: Mapping[str, Sequence[str]], stack: AsyncExitStack) -> LoopServer:
    if bus == "modbus":
        return ModbusServer(roles)
    if bus == "opcua":
        return OpcUaServer(roles)
    return MqttServer(roles, port=await stack.enter_async_context(embedded_broker()))


async def _play(
    sources: Mapping[str, Sequence[Source]],
    servers: Mapping[str, LoopServer],
    clocks: Mapping[str, Clock],
    agent: Agent,
) -> None:
    players = (play(loops, servers[bus], clocks[bus], agent.newest) for bus, loops in sources.items())
    await asyncio.gather(*players)


async def _watch(server: LoopServer, told: dict[str, bool]) -> None:
    async for loop, active in server.watch_alarms():
        told[loop] = active
        obey_cancellation()
