"""Keeps the store up to date from the event loop, which never waits for the disk."""

from __future__ import annotations

import asyncio
import logging
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import TypeVar

from agent.alarms import Alarm
from agent.runtime.store.change import Change, Waiting
from agent.runtime.store.store import Kept, Store, StoredCommand, StoreError

LOG = logging.getLogger(__name__)
NOTHING = Change()
T = TypeVar("T")


class Journal:
    """What changed and is not on disk yet, and the thread that writes it there.

    ``note`` collects changes; ``flush`` writes all of them in one transaction. So an alarm and its
    announcements, noted without a pause between them, are on disk together or not at all. If a write fails,
    the changes stay noted, and every flush tries again.
    """

    def __init__(self, path: Path | None = None, clock: Callable[[], float] = time.time) -> None:
        """Make a journal; nothing is opened yet.

        Args:
            path: Of the store; None keeps nothing.
            clock: Gives the time, s UTC.
        """
        self.failures = 0
        """Failed writes and reads of the store."""
        self._path = path
        self._clock = clock
        self.problem = ""
        """Why the store cannot be used now; empty where it can."""
        self._pending = NOTHING
        self._alarms: dict[str, Alarm] = {}
        self._waiting: dict[int, Waiting] = {}
        """All that the store should hold: it may have to be written anew."""
        self._sequence = 0
        self._store: Store | None = None
        self._writing = asyncio.Lock()
        self._next: asyncio.Task[None] | None = None
        """Will write all that is noted until it has its turn: one for all that wait for it."""
        self._thread = ThreadPoolExecutor(1, thread_name_prefix="store")

    async def open(self) -> Kept:
        """Return the content of the store; empty, with a log message, where it cannot be used."""
        if self._path is None:
            return Kept()
        try:
            kept = await self._in_thread(lambda: self._opened().read())
        except StoreError as error:
            self._failed(error)
            return Kept()
        self._sequence = kept.sequence
        self._alarms |= kept.alarms
        self._waiting |= kept.waiting
        return kept

    async def close(self) -> None:
        """Write what is noted and let go of the file."""
        await self.flush()
        if self._store is not None:
            await self._in_thread(self._store.close)
        self._thread.shutdown(wait=False)

    def next_sequence(self) -> int:
        """Return a number above all before.

        It counts from the ms since 1970, so that it rises even where a store was lost.
        """
        self._sequence = max(self._sequence + 1, int(1000 * self._clock()))
        return self._sequence

    def note(self, change: Change) -> None:
        """Remember a change for the next flush."""
        self._pending = self._pending.followed_by(change)
        self._alarms |= change.alarms
        self._waiting |= change.put
        for number in change.removed:
            self._waiting.pop(number, None)

    async def flush(self) -> None:
        """Return when all that was noted before is on disk, or the disk would not take it."""
        if self._path is None:
            self._pending = NOTHING
        elif self._next is not None or self._pending != NOTHING or self._writing.locked():
            if self._next is None:
                self._next = asyncio.create_task(self._write(), name="store")
            # A task of its own: a caller cancelled during the wait would not know what was written.
            await asyncio.shield(self._next)

    async def _write(self) -> None:
        async with self._writing:
            try:
                await self._look_at_the_file()
            finally:
                self._next = None
            change, self._pending = self._pending, NOTHING
            if change == NOTHING:
                return
            try:
                await self._in_thread(lambda: self._opened().write(change))
            except StoreError as error:
                self._pending = change.followed_by(self._pending)
                self._failed(error)
            else:
                if self.problem:
                    self.problem = ""
                    LOG.info("%s is written again", self._path, extra={"event": "store"})

    async def commands(self) -> tuple[StoredCommand, ...]:
        """Return the commands that were not obeyed yet, the oldest first."""
        if self._path is None:
            return ()
        try:
            commands = None
            if not self._writing.locked():  # who writes has looked, and may be letting go
                async with self._writing:
                    commands = await self._in_thread(self._commands_there)
                    if commands is None:
                        await self._let_go()
                if commands is None:
                    await self.flush()
            if commands is None:
                commands = await self._in_thread(lambda: self._opened().commands())
        except StoreError as error:
            self._failed(error)
            return ()
        return tuple(each for each in commands if each.number not in self._pending.taken)

    def _commands_there(self) -> tuple[StoredCommand, ...] | None:
        """Return the commands, None where the file is another one, in one turn of the thread."""
        store = self._store
        return None if store is not None and store.is_foreign() else self._opened().commands()

    async def _look_at_the_file(self) -> None:
        """Let go of a file that somebody removed or overwrote, and note all that belongs there."""
        store = self._store
        if store is not None and await self._in_thread(store.is_foreign):
            await self._let_go()

    async def _let_go(self) -> None:
        LOG.error(
            "%s was removed, replaced or overwritten by another program; it is written anew",
            self._path,
            extra={"event": "store"},
        )
        self._pending = Change(dict(self._alarms), dict(self._waiting)).followed_by(self._pending)
        store, self._store = self._store, None
        if store is not None:
            await self._in_thread(store.close)

    def _opened(self) -> Store:
        if self._store is None and self._path is not None:
            self._store = Store(self._path)
        if self._store is None:
            raise StoreError("no store")
        return self._store

    async def _in_thread(self, work: Callable[[], T]) -> T:
        return await asyncio.get_running_loop().run_in_executor(self._thread, work)

    def _failed(self, error: StoreError) -> None:
        self.failures += 1
        if not self.problem:
            self.problem = str(error)
            LOG.error(
                "%s; alarms are kept in memory until it can be written", error, extra={"event": "store"}
            )
