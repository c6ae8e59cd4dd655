"""Real processes: they survive each other, and none survives the pool."""

import asyncio
import multiprocessing
import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest

from agent.runtime.loop.workers import InlineExecutor, PoolExecutor
from tests.conftest import ROOT


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


@pytest.mark.skipif(not hasattr(os, "nice"), reason="no priorities of that kind here")
@pytest.mark.parametrize(("chosen", "behind"), [({}, 10), ({"behind": 0}, 0)])
async def test_workers_are_as_far_behind_the_agent_as_is_chosen(chosen, behind):
    async with PoolExecutor(1, **chosen) as pool:
        assert await pool.run(os.nice, 0) == min(os.nice(0) + behind, 19)


async def test_a_pool_uses_other_processes_and_leaves_none():
    async with PoolExecutor(1) as pool:
        worker = await pool.run(os.getpid)
        assert worker != os.getpid()
        # The pool must not wait for this one.
        stuck = asyncio.create_task(pool.run(time.sleep, 1000))
        await asyncio.sleep(0)
    # Python's own end would race a thread of the pool that still closes its pipes.
    assert not [thread for thread in threading.enumerate() if "ExecutorManager" in type(thread).__name__]
    stuck.cancel()
    await asyncio.wait({stuck})
    assert not multiprocessing.active_children()
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


AGENT = """
import asyncio
import os
import time

from agent.runtime.loop.workers import PoolExecutor

async def main():
    async with PoolExecutor(2) as pool:
        print(await pool.run(os.getpid), flush=True)
        await pool.run(time.sleep, 1000)

if __name__ == "__main__":
    asyncio.run(main())
"""


def test_no_worker_outlives_an_agent_that_is_killed(tmp_path):
    program = tmp_path / "agent_in_short.py"
    program.write_text(AGENT)
    with subprocess.Popen(
        [sys.executable, program],
        cwd=ROOT,
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    ) as process:
        worker = int(process.stdout.readline())
        family = {worker, *descendants(process.pid)}
        assert len(family) > 3  # two workers, who forks them, and who keeps track of their resources
        process.kill()
        said = process.stderr.read()  # ends with the last that could say anything
    deadline = time.monotonic() + 30
    while left := [pid for pid in family if running(pid)]:
        assert time.monotonic() < deadline, f"{left} outlived their agent"
        time.sleep(0.02)
    assert said == b""


def descendants(pid):
    children = [int(each) for each in Path(f"/proc/{pid}/task/{pid}/children").read_text().split()]
    return [*children, *(each for child in children for each in descendants(child))]


def running(pid):
    """Whether there is such a process; one that only waits to be counted has ended."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except (FileNotFoundError, ProcessLookupError):
        return False


async def test_a_worker_that_hangs_is_replaced():
    async with PoolExecutor(1) as pool:
        worker = await pool.run(os.getpid)
        pool._within = 0.1
        with pytest.raises(TimeoutError):
            await pool.run(time.sleep, 1000)
        pool._within = 60.0  # a busy machine takes its time to start another
        assert await pool.run(divmod, 7, 2) == (3, 1)
        assert not running(worker)
        assert pool.queued == 0
