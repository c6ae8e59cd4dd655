"""Applies a changed configuration file: after SIGHUP, or on its change if ``watch_config`` is set."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import NoReturn

from agent.runtime.agent import Agent
from agent.runtime.operate.notify import ServiceManager
from agent.settings import Settings, load_settings
from connectors.base import ConfigError
from connectors.cancellation import obey_cancellation

LOG = logging.getLogger(__name__)
LOOK = 2.0
"""Time between two looks at the files, s. One that is still being written is left until it rests."""
Marks = dict[Path, tuple[int, int, int] | None]
"""What changes when a file does; None for one that is not there."""


class Reloader:
    """Keeps an agent in line with its configuration file. ``run`` is for a supervisor."""

    def __init__(
        self,
        path: Path,
        agent: Agent,
        manager: ServiceManager,
        requested: asyncio.Event,
        load: Callable[[Path], Settings] = load_settings,
        applied: Callable[[], None] = lambda: None,
    ) -> None:
        """Make it.

        Args:
            path: Path of the configuration file.
            agent: Agent that already runs with it.
            manager: Gets a notification when the file is read again.
            requested: Set it to have the file read again.
            load: Reads the file, or this agent's part of it.
            applied: Called after each change.
        """
        self.refused = 0
        """Times that the file had faults and was not applied."""
        self._path = path
        self._load, self._applied = load, applied
        self._agent = agent
        self._manager = manager
        self._requested = requested
        self._taken = _marks(self._files())
        """Of the files as they were last read."""

    async def run(self) -> NoReturn:
        """Apply changes until cancelled."""
        while True:
            await self._wait()
            self._requested.clear()
            await self._take_over()
            obey_cancellation()

    async def _wait(self) -> None:
        """Wait for a request, or until a file has changed and is no longer being written."""
        watches, before = self._agent.settings.agent.watch_config, self._taken
        while True:
            try:
                async with asyncio.timeout(LOOK if watches else None):
                    await self._requested.wait()
                    return
            except TimeoutError:
                now = await asyncio.to_thread(_marks, self._files())
                if now == before != self._taken and None not in now.values():
                    return
                before = now

    async def _take_over(self) -> None:
        self._manager.reloading()
        read = _marks(self._files())
        try:
            settings = await asyncio.to_thread(self._load, self._path)
            await self._agent.reload(settings)
            self._applied()
        except ConfigError as error:
            self.refused += 1
            for fault in error.faults:
                LOG.error("%s", fault, extra={"event": "refused"})  # noqa: TRY400 - a fault of the file
            LOG.error(  # noqa: TRY400
                "%s was not applied; the agent continues with its previous settings",
                self._path,
                extra={"event": "refused"},
            )
        finally:
            # of a list that is new the marks are those of now, of the others those before they were read
            now = _marks(self._files())
            self._taken = now | {path: mark for path, mark in read.items() if path in now}
            self._manager.ready(self._agent.summary)

    def _files(self) -> Iterable[Path]:
        return (self._path, *self._agent.settings.lists)


def _marks(files: Iterable[Path]) -> Marks:
    return {path: _mark(path) for path in files}


def _mark(path: Path) -> tuple[int, int, int] | None:
    try:
        found = path.stat()
    except OSError:
        return None
    return found.st_mtime_ns, found.st_size, found.st_ino
