"""Sends the history from the file on this machine to a database, in order, each entry once."""

from __future__ import annotations

import asyncio
import logging
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING, NoReturn

from agent.runtime.store.database import StoreError
from agent.runtime.store.history_file import HistoryFile
from connectors.cancellation import obey_cancellation

if TYPE_CHECKING:
    from pathlib import Path

    from agent.runtime.store.postgres_history import PostgresHistory
    from agent.settings import HistoryDatabase

LOG = logging.getLogger(__name__)
BATCH = 500
"""Entries in one transaction: some MB at most."""
PAUSE = 2.0
"""Before the file is looked into again, s."""
AGAIN = 10.0
"""From one attempt to the next while the database does not answer, s."""


class Forwarder:
    """``run`` is for a supervisor. The event loop never waits for the database."""

    def __init__(self, path: Path, settings: HistoryDatabase) -> None:
        """Make it; nothing is connected yet.

        Args:
            path: Of the history's file.
            settings: Of the database.
        """
        self.sent = 0
        """Entries that the database took since the start."""
        self.dropped = 0
        """Entries that the file dropped, being full, before the database came back."""
        self._path, self._settings = path, settings
        self._problem = ""
        self._file: HistoryFile | None = None
        self._database: PostgresHistory | None = None
        self._origin, self._position = "", 0
        self._thread = ThreadPoolExecutor(1, thread_name_prefix="history database")

    async def run(self) -> NoReturn:
        """Send what comes, until cancelled."""
        while True:
            try:
                # A task of its own: one that is cancelled would leave the thread with the connection.
                sent = await asyncio.shield(asyncio.create_task(self._in_thread(), name="history database"))
            except StoreError as error:
                if not self._problem:
                    text = "%s; entries wait in the file until it answers"
                    LOG.error(text, error, extra={"event": "history_database"})  # noqa: TRY400
                self._problem = str(error)
                await asyncio.sleep(AGAIN)
                continue
            obey_cancellation()
            if sent < BATCH:
                await asyncio.sleep(PAUSE)

    async def close(self) -> None:
        """Let go of file and database; what was not sent is sent after the next start."""
        await asyncio.get_running_loop().run_in_executor(self._thread, self._let_go)
        self._thread.shutdown(wait=False)

    async def _in_thread(self) -> int:
        sent = await asyncio.get_running_loop().run_in_executor(self._thread, self.send)
        if self._problem:
            self._problem = ""
            text = "%s takes entries again"
            LOG.info(text, self._settings.url, extra={"event": "history_database"})
        return sent

    def send(self) -> int:
        """Send the next entries; return how many they were. Raises StoreError, and then begins afresh."""
        if not self._path.exists():
            return 0  # nothing was written yet
        try:
            return self._send()
        except StoreError:
            self._let_go()
            raise

    def _send(self) -> int:
        if self._file is None:
            self._file = HistoryFile(self._path, create=False)
            self._origin = self._file.origin()
        if self._database is None:
            from agent.runtime.store.postgres_history import PostgresHistory  # noqa: PLC0415 - few have one

            self._database = PostgresHistory(self._settings)
            self._position = self._database.position(self._origin)
        entries = self._file.after(self._position, BATCH)
        if not entries:
            return 0
        missed = entries[0].number - self._position - 1
        if missed and self._position:
            self.dropped += missed
            text = "%s: %d entries were dropped by the full file before they could be sent"
            LOG.error(text, self._settings.url, missed, extra={"event": "history_database"})
        self._database.take(self._origin, entries)
        self._position = entries[-1].number
        self.sent += len(entries)
        return len(entries)

    def _let_go(self) -> None:
        if self._database is not None:
            self._database.close()
        if self._file is not None:
            self._file.close()
        self._database = self._file = None
