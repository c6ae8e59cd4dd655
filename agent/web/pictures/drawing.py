"""Calculations that pages request: in a process of their own, one at a time, behind the diagnoses."""

from __future__ import annotations

import asyncio
import contextlib
import signal
from collections import OrderedDict
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from typing import Any, NoReturn, TypeVar

from agent.runtime.capabilities import step_back
from agent.runtime.loop.process_pool import process_pool

KEPT = 64
"""Results that are kept for the next page."""
NICE = 5
"""How much the process gives way to diagnoses."""
T = TypeVar("T")


class Drawing:
    """Starts its process when it is first needed. ``run`` ends it and is for a supervisor."""

    def __init__(self) -> None:
        self._pool: ProcessPoolExecutor | None = None
        self._results: OrderedDict[tuple[object, ...], Any] = OrderedDict()
        self._one = asyncio.Lock()

    async def calculated(self, key: tuple[object, ...], function: Callable[..., T], *arguments: object) -> T:
        """Return ``function(*arguments)``, module-level and of values; a result known by ``key`` is kept."""
        async with self._one:
            if key not in self._results:
                self._results[key] = await self._run(function, *arguments)
                if len(self._results) > KEPT:
                    self._results.popitem(last=False)
            found: T = self._results[key]
            return found

    async def run(self) -> NoReturn:
        """Wait until cancelled, then end the process."""
        try:
            while True:
                await asyncio.Event().wait()
        finally:
            pool, self._pool = self._pool, None
            if pool is not None:
                pool.shutdown(wait=False, cancel_futures=True)

    async def _run(self, function: Callable[..., T], *arguments: object) -> T:
        """Try once more where the process died (out of memory, killed)."""
        with contextlib.suppress(BrokenProcessPool):
            return await self._once(function, *arguments)
        self._pool = None
        return await self._once(function, *arguments)

    async def _once(self, function: Callable[..., T], *arguments: object) -> T:
        if self._pool is None:
            self._pool = process_pool(1, _prepare)
        return await asyncio.get_running_loop().run_in_executor(self._pool, function, *arguments)


def _prepare() -> None:
    """Ctrl-C is for the agent; and diagnoses come first."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    step_back(NICE)
