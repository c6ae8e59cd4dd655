"""Real processes: they survive each other, and none survives the pool."""

import asyncio
import os
import signal
import time

import pytest

from agent.runtime.workers import InlineExecutor, PoolExecutor


@pytest.fixture(params=["inline", "pool"])
async def executor(request):
    if request.param == "inline":
        yield InlineExecutor()
        return
    async with PoolExecutor(1) as pool:
        yield pool


async def test_it_gives_the_value_and_the_fault(executor):
    assert await executor.run(divmod, 7, 2) == (3, 1)
    with pytest.raises(ZeroDivisionError):
        await executor.run(divmod, 7, 0)


async def test_a_pool_uses_other_processes_and_leaves_none():
    async with PoolExecutor(1) as pool:
        worker = await pool.run(os.getpid)
        assert worker != os.getpid()
        # The pool must not wait for this one.
        stuck = asyncio.create_task(pool.run(time.sleep, 1000))
        await asyncio.sleep(0)
    stuck.cancel()
    await asyncio.wait({stuck})
    async with asyncio.timeout(10):
        while alive(worker):  # noqa: ASYNC110 - another process tells no event
            await asyncio.sleep(0.02)


async def test_a_worker_that_dies_costs_nothing_but_time():
    async with PoolExecutor(1) as pool:
        worker = await pool.run(os.getpid)
        os.kill(worker, signal.SIGKILL)
        assert await pool.run(divmod, 7, 2) == (3, 1)


def alive(pid):
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    return True
