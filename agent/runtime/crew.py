"""Supervised tasks that can start and end while the others continue."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Callable, Collection, Coroutine
from types import TracebackType
from typing import Any, Self

from agent.runtime.supervisor import LONGEST_WAIT, Health, keep_alive

LOG = logging.getLogger(__name__)
END_WITHIN = 30.0
"""s; each piece of work has shorter limits of its own, this is for one that fails to keep them."""


class Crew:
    """Named tasks in one TaskGroup; all end with it.

    For example::

        async with Crew() as crew:
            crew.start(health, connection.attempt)
            await crew.end([health.name])
    """

    def __init__(self) -> None:
        self._group = asyncio.TaskGroup()
        self._tasks: dict[str, asyncio.Task[None]] = {}
        self.members: dict[str, Health] = {}
        """State of each task, by its name."""

    async def __aenter__(self) -> Self:
        """Start without tasks."""
        await self._group.__aenter__()
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Wait for all, who go on until this task is cancelled."""
        await self._group.__aexit__(kind, error, trace)

    def start(
        self,
        health: Health,
        work: Callable[[], Coroutine[Any, Any, object]],
        longest_wait: float = LONGEST_WAIT,
    ) -> None:
        """Keep ``work`` alive from now on, under the name of its health."""
        task = self._group.create_task(keep_alive(work, health, longest_wait), name=health.name)
        self._tasks[health.name] = task
        self.members[health.name] = health

    def abort(self, error: Exception) -> None:
        """End all, and have ``error`` raised where the crew is waited for."""

        async def fail() -> None:
            raise error

        self._group.create_task(fail(), name="abort")

    async def end(self, names: Collection[str]) -> None:
        """End these, and return when they have."""
        tasks = {self._tasks.pop(name) for name in names}
        for name in names:
            del self.members[name]
        for task in tasks:
            task.cancel()
        if tasks:
            _, left = await asyncio.wait(tasks, timeout=END_WITHIN)
            for task in left:
                LOG.error("%s did not end within %.0f s and was abandoned", task.get_name(), END_WITHIN)
