"""What can go wrong, each told to the rig by name; it returns when the peer is back."""

import asyncio
import time

from agent.runtime.store.change import Change, Waiting
from connectors.base import Publication
from connectors.checks import proxy as faults
from tests.faults.peer import TURN
from tests.faults.rig import until

CLOCK_STEP = 4 * TURN
"""About an hour, s; a multiple of TURN, so that values stay comparable with times."""
YEARS = round(26 * 365.25 * 86400 / TURN) * TURN
"""What a controller is behind whose battery is empty, s."""


def proxied(fault):
    """Have the proxy do it for a while."""

    async def scenario(rig, seconds, _patch):
        async with rig.proxy.suffering(fault):
            await asyncio.sleep(0.0 if fault is faults.RESET else seconds)

    return scenario


async def killed(rig, seconds, _patch):
    """SIGKILL the peer; it starts again on the same port."""
    await rig.peer.kill()
    await asyncio.sleep(seconds)
    await rig.peer.start()


async def removed(rig, seconds, _patch):
    """Take the nodes, registers or messages of the loop away for a while."""
    await rig.peer.order("remove")
    await asyncio.sleep(seconds)
    await rig.peer.order("restore")


async def twice(rig, _seconds, _patch):
    """Lose the connection, and again as soon as data flow."""
    await rig.proxy.begin(faults.RESET)
    await rig.flows(time.time() + rig.peer.offset)
    await rig.proxy.begin(faults.RESET)
    await rig.proxy.end()


async def full_disk(rig, seconds, _patch):
    """Let the store take no more: what changes is in memory until there is room, and is told."""
    journal = rig.agent.journal
    await until(lambda: journal._store is not None)
    database = journal._store._database._database

    def most_pages(count):
        return journal._in_thread(lambda: database.execute(f"PRAGMA max_page_count = {count}").fetchone())

    failures, number = journal.failures, journal.next_sequence()
    await most_pages(1)  # SQLite then allows as many as there are
    large = Publication("nobody", "event", "large", {"text": "x" * 100_000})  # too large for any free page
    journal.note(Change(put={number: Waiting("nobody", large)}))
    await until(lambda: journal.failures > failures + 2)
    await asyncio.sleep(seconds)
    await most_pages(1_000_000)
    journal.note(Change(removed=frozenset({number})))
    failures = journal.failures
    await journal.flush()
    assert journal.failures == failures


async def source_clock(rig, seconds, _patch):
    """The plant's clock is set forward by an hour, and back."""
    for step in (CLOCK_STEP, -CLOCK_STEP):
        await rig.peer.order(f"clock {step}")
        await asyncio.sleep(seconds)


async def source_clock_absurd(rig, seconds, _patch):
    """The plant's clock is 26 years behind for a while, as after an empty battery."""
    await rig.peer.order(f"clock {-YEARS}")
    await rig.flows(time.time())
    assert abs(rig.windows[-1].time[-1] - time.time()) < 30, "the agent believes an absurd clock"
    await asyncio.sleep(seconds)
    await rig.peer.order(f"clock {YEARS}")


async def gateway_clock(_rig, seconds, patch):
    """The clock of the agent's machine is set forward by an hour, and back."""
    real = time.time
    for step in (CLOCK_STEP, 0.0):
        patch.setattr(time, "time", lambda step=step: real() + step)
        await asyncio.sleep(seconds)
    patch.undo()


SCENARIOS = {
    "reset": proxied(faults.RESET),
    "refuse": proxied(faults.REFUSE),
    "stall": proxied(faults.STALL),
    "black_hole": proxied(faults.BLACK_HOLE),
    "latency": proxied(faults.LATENCY),
    "slices": proxied(faults.SLICES),
    "corrupt": proxied(faults.CORRUPT),
    "truncate": proxied(faults.TRUNCATE),
    "cut": proxied(faults.CUT),
    "slow": proxied(faults.THROTTLE),
    "killed": killed,
    "removed": removed,
    "twice": twice,
    "full_disk": full_disk,
    "source_clock": source_clock,
    "source_clock_absurd": source_clock_absurd,
    "gateway_clock": gateway_clock,
}
SPOILS_VALUES = {"corrupt"}
"""Nobody can tell a flipped bit in a value from a value: TCP's checksum passed it."""
