"""SIGKILL at random moments while the way to the broker has every fault: no alarm is lost, none doubled."""

import asyncio
import contextlib
import random
import sys

import pytest

from connectors.checks import proxy as faults
from connectors.checks.proxy import FaultProxy
from tests.conftest import ROOT
from tests.faults.rig import DEADLINE, Consumer, Peer

FAULTS = (
    faults.RESET,
    faults.REFUSE,
    faults.STALL,
    faults.BLACK_HOLE,
    faults.LATENCY,
    faults.SLICES,
    faults.TRUNCATE,
    faults.CUT,
)


@contextlib.asynccontextmanager
async def started(store, port, task):
    program = await asyncio.create_subprocess_exec(
        sys.executable, "-m", "tests.faults.killed_program", str(store), str(port), task,
        cwd=ROOT, stdout=asyncio.subprocess.PIPE,
    )  # fmt: skip
    try:
        assert await asyncio.wait_for(program.stdout.readline(), DEADLINE) == b"ready\n"
        yield program
    finally:
        with contextlib.suppress(ProcessLookupError):
            program.kill()
        await program.wait()


@pytest.mark.parametrize(
    "kills",
    [
        pytest.param(1, marks=pytest.mark.timeout(240)),
        pytest.param(24, marks=[pytest.mark.bench, pytest.mark.timeout(1200)]),
    ],
)
async def test_alarms_survive_sigkill_amid_faults(mosquitto, tmp_path, kills):
    store, chance, broker = tmp_path / "plant.sqlite", random.Random(kills), Peer("mqtt", mosquitto, tmp_path)
    await broker.start()
    consumer = Consumer()
    reading = asyncio.create_task(consumer.run(broker.port))
    try:
        async with FaultProxy(broker.port) as proxy:
            for kill in range(kills):
                async with started(store, proxy.port, "work"):
                    await asyncio.sleep(chance.uniform(0, 0.3))  # it works meanwhile, and dies wherever it is
                    await proxy.begin(FAULTS[kill % len(FAULTS)])
                    await asyncio.sleep(chance.uniform(0, 0.3))
            await proxy.end()
            async with started(store, proxy.port, "drain") as program:
                windows = int(await asyncio.wait_for(program.stdout.readline(), 2 * DEADLINE))
        async with asyncio.timeout(DEADLINE):
            while len(consumer.events) < windows:  # noqa: ASYNC110
                await asyncio.sleep(0.02)
    finally:
        reading.cancel()
        await asyncio.wait({reading})
        await broker.stop()
    told = list(consumer.events.values())
    assert [event["time"] for event in told] == list(range(1, windows + 1))
    assert [event["active"] for event in told] == [bool(k % 2) for k in range(1, windows + 1)]
    assert windows > kills
