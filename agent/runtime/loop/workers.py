"""Where heavy calculations run: in other processes, or right here for tests in virtual time."""

from __future__ import annotations

import asyncio
import functools
import signal
from collections.abc import Callable
from concurrent.futures.process import BrokenProcessPool
from types import TracebackType
from typing import TYPE_CHECKING, Protocol, Self, TypeVar

from agent.runtime.capabilities import step_back
from agent.runtime.loop.process_pool import end_workers, process_pool
from agent.runtime.loop.turns import Turns

if TYPE_CHECKING:
    from concurrent.futures import ProcessPoolExecutor

T = TypeVar("T")
WITHIN = 600.0
"""s; a diagnosis takes seconds."""
BEHIND = 10
"""By how much workers are nicer than the agent: where cores are few, samples come in first."""


class Executor(Protocol):
    """Runs a function of values and gives its value."""

    @property
    def queued(self) -> int:
        """Calculations that wait for a worker."""
        ...

    async def run(self, function: Callable[..., T], *args: object) -> T:
        """Return ``function(*args)``, or raise what it raises."""
        ...

    async def run_in_turn(
        self, expected: float, work: Callable[[], Callable[[], T]], worth: float = 1.0
    ) -> T:
        """Wait until a worker is free, then run what ``work`` returns at that moment.

        Args:
            expected: Time that the calculation should take, s; the quick ones come first.
            work: Gives the calculation, picklable: what is newest, however long its turn took to come.
            worth: Of its answer, over that of a usual one, > 0: what is worth more comes earlier.
        """
        ...


class InlineExecutor:
    """Runs in the event loop, which stands still meanwhile."""

    queued = 0

    async def run(self, function: Callable[..., T], *args: object) -> T:
        """Return ``function(*args)``."""
        return function(*args)

    async def run_in_turn(
        self,
        expected: float,  # noqa: ARG002
        work: Callable[[], Callable[[], T]],
        worth: float = 1.0,  # noqa: ARG002
    ) -> T:
        """Return what the calculation of ``work`` returns."""
        return work()()


class PoolExecutor:
    """Runs in processes of its own. Functions and arguments are pickled, so functions are module-level ones.

    For example::

        async with PoolExecutor(workers=2) as executor:
            diagnosis = await executor.run(diagnose, window)
    """

    def __init__(self, workers: int, within: float = WITHIN, behind: int = BEHIND) -> None:
        """Make it.

        Args:
            workers: Processes, one core each.
            within: Longest time for one calculation, s; then its worker counts as hung.
            behind: By how much they are nicer than the agent.
        """
        self._workers = workers
        self._within = within
        self._behind = behind
        self._turns = Turns(workers)
        self._ended = False
        self._pool = self._new_pool()

    @property
    def queued(self) -> int:
        """Calculations that wait for a worker."""
        return self._turns.waiting

    async def run(self, function: Callable[..., T], *args: object) -> T:
        """Return ``function(*args)``; raises TimeoutError where that takes too long."""
        return await self.run_in_turn(0.0, lambda: functools.partial(function, *args))

    async def run_in_turn(
        self, expected: float, work: Callable[[], Callable[[], T]], worth: float = 1.0
    ) -> T:
        """Return what the calculation of ``work`` returns; raises TimeoutError where that takes too long."""
        async with self._turns.turn(expected, worth):
            try:
                async with asyncio.timeout(self._within):
                    return await self._run(work())
            except TimeoutError:
                end_workers()  # those of other calculations are started once more
                raise

    async def _run(self, function: Callable[[], T]) -> T:
        """Try once more where a worker died (out of memory, killed)."""
        pool = self._pool
        try:
            return await asyncio.get_running_loop().run_in_executor(pool, function)
        except BrokenProcessPool:
            if self._ended:
                raise
            if pool is self._pool:  # the first of those that waited for this pool
                pool.shutdown(wait=False)
                self._pool = self._new_pool()
            return await asyncio.get_running_loop().run_in_executor(self._pool, function)

    async def __aenter__(self) -> Self:
        """Start the workers, so that the first window doesn't wait for imports."""
        await asyncio.gather(*(self.run(_import_analysis) for _ in range(self._workers)))
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """End the workers at once, whatever they do: nobody waits for their answers any more."""
        self._ended = True
        end_workers()
        # Waits for the pool's own thread: the end of Python 3.11 would race it for a pipe that it is closing.
        await asyncio.to_thread(self._pool.shutdown, cancel_futures=True)

    def _new_pool(self) -> ProcessPoolExecutor:
        return process_pool(self._workers, _prepare, self._behind)


def _import_analysis() -> None:
    import agent.analysis.diagnose  # noqa: PLC0415
    import agent.analysis.routine  # noqa: F401, PLC0415  # here, so that only workers pay for it at start


def _prepare(behind: int) -> None:
    """Ctrl-C goes to the whole group of processes; only the agent may act on it, and it comes first."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    step_back(behind)
