"""The daemon against real servers: what a plant said is what a window holds, and its alarm is on the bus."""

import asyncio
from contextlib import AsyncExitStack, aclosing

import numpy as np
import pytest

from agent.runtime.agent import Agent
from agent.runtime.loop.workers import InlineExecutor
from agent.settings import settings_of
from simulators.clock import Clock
from simulators.plant import Row
from simulators.player import play
from simulators.servers.broker import embedded_broker
from simulators.servers.modbus import ModbusServer
from simulators.servers.mqtt import MqttServer
from simulators.servers.opcua import OpcUaServer
from tests.unit.runtime.agents import judged

START, N = 1.7e9, 400
LOOPS = {"FIC101": ("pv", "op", "sp"), "FIC102": ("pv", "op", "sp")}


class Swing:
    """A loop that oscillates, PV and OP coarse enough to repeat values; one row is missing and one is bad."""

    ts = 1.0

    def __init__(self, loop):
        self.loop = loop
        phase = np.arange(N) / 8 + len(loop)
        self.pv = np.round(50 + 5 * np.sin(phase), 1)
        self.op = np.round(50 - 5 * np.cos(phase), 1)
        self.pv[100] = np.nan

    def rows(self):
        for k in range(N):
            if k != 200:
                values = {"pv": float(self.pv[k]), "op": float(self.op[k]), "sp": 50.0}
                yield Row(START + k, values)


async def server_of(bus, stack):
    if bus == "modbus":
        return await stack.enter_async_context(ModbusServer(LOOPS))
    if bus == "opcua":
        return await stack.enter_async_context(OpcUaServer(LOOPS))
    port = await stack.enter_async_context(embedded_broker())
    return await stack.enter_async_context(MqttServer(LOOPS, port=port))


@pytest.mark.parametrize("bus", ["modbus", "opcua", "mqtt"])
async def test_from_the_plant_to_the_alarm(bus):
    sources, windows = [Swing(loop) for loop in LOOPS], []

    def diagnose(window, _seen=None):
        windows.append(window)
        return judged("stiction" if window.loop == "FIC101" else "no_stiction")(window)

    async with AsyncExitStack() as stack:
        server = await server_of(bus, stack)
        one_window = {"window": {"seconds": 300.0, "hop": 1.0}, "alarm": {"on_delay": 1}}
        settings = settings_of(
            {
                "agent": {"clock_error": None},
                "connections": {server.name: server.connection_settings()},
                "loops": [{**server.loop_settings(loop, 1.0), **one_window} for loop in LOOPS],
            }
        )
        agent = Agent(settings, InlineExecutor(), diagnose=diagnose)
        told = asyncio.create_task(first_alarm(server))
        work = asyncio.create_task(agent.run())
        try:
            async with asyncio.timeout(30):
                await play(sources, server, Clock(None), agent.newest)
                assert await told == "FIC101"
        finally:
            work.cancel()
            told.cancel()
            await asyncio.wait({work, told})

    assert {window.loop for window in windows} == set(LOOPS)
    for window in windows:
        source = next(source for source in sources if source.loop == window.loop)
        first = round(window.start - START)
        assert first == 0
        missing = np.isin(np.arange(N), (100, 200))
        expected = np.where(missing, np.nan, source.pv)[: len(window)]
        np.testing.assert_allclose(window.pv, expected, rtol=1e-6)
        assert window.sp is not None
        np.testing.assert_array_equal(window.sp[:100], 50.0)


async def first_alarm(server):
    async with aclosing(server.watch_alarms()) as alarms:
        async for loop, active in alarms:
            if active:
                return loop
    return None
