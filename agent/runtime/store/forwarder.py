"""Sends what a file on this machine holds to a database, in order, each row once."""

from __future__ import annotations

import asyncio
import logging
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING, Generic, NoReturn, Protocol, TypeVar

from agent.runtime.store.database import StoreError
from connectors.cancellation import obey_cancellation

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path

    from agent.settings import HistoryDatabase

LOG = logging.getLogger(__name__)
BATCH = 500
"""Rows in one transaction: some MB at most."""
PAUSE = 2.0
"""Before the file is looked into again, s."""
AGAIN = 10.0
"""From one attempt to the next while the database does not answer, s."""


class NumberedRow(Protocol):
    """What a file holds."""

    @property
    def number(self) -> int:
        """Its place: rises from one row to the next."""
        ...


RowT = TypeVar("RowT", bound=NumberedRow)
TakenT_contra = TypeVar("TakenT_contra", bound=NumberedRow, contravariant=True)


class RowSource(Protocol[RowT]):
    """A file that holds rows until they were sent."""

    def origin(self) -> str:
        """Return its identity."""
        ...

    def after(self, number: int, limit: int) -> Sequence[RowT]:
        """Return the next rows behind a number, at most ``limit``."""
        ...

    def lost(self, number: int, rows: Sequence[RowT]) -> int:
        """Return how much is missing in rows that were read behind a number."""
        ...

    def delivered(self, number: int) -> None:
        """Take note that the database has all up to a number."""
        ...

    def is_gone(self) -> bool:
        """Return whether another file, or none, has its place."""
        ...

    def close(self) -> None:
        """Let go of it."""
        ...


class RowDestination(Protocol[TakenT_contra]):
    """A database that keeps rows of many files."""

    def position(self, origin: str) -> int:
        """Return the number of the last row of a file that is there; 0: none."""
        ...

    def take(self, origin: str, rows: Sequence[TakenT_contra], /) -> None:
        """Keep rows, all or none, each once."""
        ...

    def close(self) -> None:
        """Let go of it."""
        ...


class Forwarder(Generic[RowT]):
    """``run`` is for a supervisor. The event loop never waits for the database."""

    def __init__(
        self,
        path: Path,
        settings: HistoryDatabase,
        open_file: Callable[[Path], RowSource[RowT]],
        open_database: Callable[[HistoryDatabase], RowDestination[RowT]],
        what: str,
    ) -> None:
        """Make it; nothing is connected yet.

        Args:
            path: Of the file.
            settings: Of the database.
            open_file: Opens a file that is there.
            open_database: Connects.
            what: What is sent, in the plural, for the log.
        """
        self.sent = 0
        """Rows that the database took since the start."""
        self.dropped = 0
        """What the file dropped, being full, before the database came back."""
        self._path, self._settings, self.what = path, settings, what
        self._open_file, self._open_database = open_file, open_database
        self._problem = ""
        self._file: RowSource[RowT] | None = None
        self._database: RowDestination[RowT] | None = None
        self._origin, self._position = "", 0
        self._in_doubt: Sequence[RowT] = ()
        self._thread = ThreadPoolExecutor(1, thread_name_prefix="history database")

    async def run(self) -> NoReturn:
        """Send what comes, until cancelled."""
        while True:
            try:
                # A task of its own: one that is cancelled would leave the thread with the connection.
                sent = await asyncio.shield(asyncio.create_task(self._in_thread(), name="history database"))
            except StoreError as error:
                if not self._problem:
                    text = "%s; %s wait in the file until it answers"
                    LOG.error(text, error, self.what, extra={"event": "history_database"})  # noqa: TRY400
                self._problem = str(error)
                await asyncio.sleep(AGAIN)
                continue
            obey_cancellation()
            if not sent:
                await asyncio.sleep(PAUSE)

    async def close(self) -> None:
        """Let go of file and database; what was not sent is sent after the next start."""
        await asyncio.get_running_loop().run_in_executor(self._thread, self._let_go)
        self._thread.shutdown(wait=False)

    async def _in_thread(self) -> int:
        sent = await asyncio.get_running_loop().run_in_executor(self._thread, self.send)
        if self._problem:
            self._problem = ""
            text = "%s takes %s again"
            LOG.info(text, self._settings.url, self.what, extra={"event": "history_database"})
        return sent

    def send(self) -> int:
        """Send the next rows; return how many they were. Raises StoreError, and then begins afresh."""
        if self._file is not None and self._file.is_gone():
            self._let_go()
            self._in_doubt = ()
        if not self._path.exists():
            return 0  # nothing was written yet
        try:
            return self._send()
        except StoreError:
            self._let_go()
            raise

    def _send(self) -> int:
        if self._file is None:
            self._file = self._open_file(self._path)
            self._origin = self._file.origin()
        if self._database is None:
            self._database = self._open_database(self._settings)
            position = self._database.position(self._origin)
            if self._in_doubt and position == self._in_doubt[-1].number:
                self._taken(self._file, self._in_doubt)  # only the answer was lost
            self._in_doubt, self._position = (), position
        rows = self._file.after(self._position, BATCH)
        if not rows:
            return 0
        self._in_doubt = rows
        self._database.take(self._origin, rows)
        self._in_doubt = ()
        self._taken(self._file, rows)
        return len(rows)

    def _taken(self, file: RowSource[RowT], rows: Sequence[RowT]) -> None:
        """Count rows that the database has, and what was missing before them."""
        lost = file.lost(self._position, rows)
        if lost:
            self.dropped += lost
            text = "%s: %d %s were dropped by the full file before they could be sent"
            LOG.error(text, self._settings.url, lost, self.what, extra={"event": "history_database"})
        self._position = rows[-1].number
        self.sent += len(rows)
        file.delivered(self._position)

    def _let_go(self) -> None:
        if self._database is not None:
            self._database.close()
        if self._file is not None:
            self._file.close()
        self._database = self._file = None
