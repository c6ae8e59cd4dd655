"""The fault matrix: what must hold whatever happens between the agent and its plant."""

import asyncio
import time

from tests.faults.rig import DEADLINE, rig
from tests.faults.scenarios import SCENARIOS, SPOILS_VALUES

BUSES = ("modbus", "opcua", "mqtt")
LASTS = 3.0
"""s, of a fault in the whole matrix."""


async def outlived(plant, name, seconds, patch):
    """Have one fault; return how long it took from its end until data flowed, s."""
    agent = plant.agent
    tasks = {each.health.name for each in agent.connections} | {each.name for each in agent.health.values()}
    first, beats = len(plant.windows), plant.beats
    await SCENARIOS[name](plant, seconds, patch)
    back = time.monotonic()
    await plant.flows(time.time() + plant.peer.offset)
    took = time.monotonic() - back
    assert tasks <= {task.get_name() for task in asyncio.all_tasks()}, "a task was lost"
    assert plant.beats > beats, "another connection was held up"
    assert name in SPOILS_VALUES or not plant.wrong(first), "a window holds what the plant did not say"
    assert plant.escaped == [], "an exception escaped"
    health = [connection.health for connection in agent.connections] + [*agent.health.values()]
    assert [each.problem for each in health if each.faults] == [], "a fault of the program"
    return took


async def nothing_is_lost(plant):
    """The outbox empties, no connection is left behind, and each event was told, once by its id."""
    outbox = plant.agent.outboxes[plant.bus]
    async with asyncio.timeout(DEADLINE):
        while len(outbox) or plant.proxy.open != 1:  # noqa: ASYNC110
            await asyncio.sleep(0.005)
    assert outbox.dropped == 0
    if plant.bus != "mqtt":
        return
    async with asyncio.timeout(DEADLINE):
        while True:
            told = [event["active"] for event in plant.consumer.events.values()]
            if told == plant.expected:
                break
            assert len(told) <= len(plant.expected), (told, plant.expected)
            await asyncio.sleep(0.05)
    assert len(told) >= 3


async def measured(bus, mosquitto, folder, patch):
    """Have every fault on one bus, with the waits that a user gets; return how long each recovery took, s."""
    async with rig(bus, mosquitto, folder) as plant:
        names = [name for name in SCENARIOS if name != "gateway_clock"]
        took = {name: await outlived(plant, name, LASTS, patch) for name in names}
        await nothing_is_lost(plant)
    if bus != "opcua":  # whose values always bring a time along
        async with rig(bus, mosquitto, folder, source_time=False) as plant:
            took["gateway_clock"] = await outlived(plant, "gateway_clock", LASTS, patch)
    return took
