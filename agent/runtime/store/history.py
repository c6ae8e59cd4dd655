"""Remembers diagnoses and changes of alarms; the event loop never waits for the disk."""

from __future__ import annotations

import asyncio
import logging
import time
from collections import deque
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import NoReturn

from agent.alarms import Announcement
from agent.report.diagnosis_json import diagnosis_json
from agent.runtime.loop.judged import Judged
from agent.runtime.store.database import StoreError, unless_gone
from agent.runtime.store.history_file import Entry, HistoryFile
from agent.runtime.store.kept_window import KeptWindow, is_of_interest
from agent.settings import HistorySettings
from connectors.cancellation import obey_cancellation

LOG = logging.getLogger(__name__)
GATHER = 2.0
"""Time for which entries gather before they are written together, s."""
AGAIN = 30.0
"""Time from one attempt to the next after a failed write, s."""
LIMIT = 5000
"""Entries that may wait in memory; beyond it the oldest are discarded."""
LIMIT_WINDOWS = 200
"""Windows whose values may wait in memory, some 10 MB; beyond it only their verdicts do."""
DAY = 86400.0
"""s"""
MB = 1e6
"""bytes"""


class History:
    """An observer of loops that writes verdicts and alarm changes. ``run`` is for a supervisor."""

    def __init__(self, path: Path, settings: HistorySettings, clock: Callable[[], float] = time.time) -> None:
        """Make it; nothing is opened yet.

        Args:
            path: Of the file.
            settings: How much is kept.
            clock: Gives the time, s UTC.
        """
        self.dropped = 0
        """Entries that were lost because they could not be written."""
        self._path = path
        self._settings = settings
        self._clock = clock
        self._waiting: deque[Entry] = deque()
        self._filled = asyncio.Event()
        self._problem = ""
        self._file: HistoryFile | None = None
        self._writing = asyncio.Lock()
        self._thread = ThreadPoolExecutor(1, thread_name_prefix="history")

    def judged(self, judged: Judged) -> None:
        """Remember a verdict."""
        content = diagnosis_json(judged.diagnosis, "")
        del content["recording"]
        if self._settings.database is None:  # large, and only a database keeps the evidence
            del content["methods"]
        window = None
        if self._settings.windows and is_of_interest(judged.diagnosis, alarmed=judged.alarmed):
            window = KeptWindow.of(judged.cut.open())
            if sum(bool(each.window) for each in self._waiting) >= LIMIT_WINDOWS:
                window = window.without_values()
        self._put(Entry(judged.end, judged.diagnosis.loop, "diagnosis", content, window))

    def announced(self, announcement: Announcement) -> None:
        """Remember a change of an alarm."""
        self._put(Entry(announcement.time, announcement.alarm.loop, "alarm", dict(announcement.fields())))

    def noted(self, entry: Entry) -> None:
        """Remember what a person decided, with the comment."""
        self._put(entry)

    async def run(self) -> NoReturn:
        """Write what comes, until cancelled."""
        while True:
            await self._filled.wait()
            await asyncio.sleep(GATHER)
            written = await self._flush()
            obey_cancellation()
            if not written:
                await asyncio.sleep(AGAIN)

    async def close(self) -> None:
        """Write what waits and let go of the file."""
        await self._flush()
        if self._file is not None:
            await asyncio.get_running_loop().run_in_executor(self._thread, self._file.close)
        self._thread.shutdown(wait=False)

    def _put(self, entry: Entry) -> None:
        self._waiting.append(entry)
        if len(self._waiting) > LIMIT:
            self._waiting.popleft()
            self.dropped += 1
        self._filled.set()

    async def _flush(self) -> bool:
        """Write what waits; return whether the disk took it."""
        # A task of its own: a caller cancelled during the wait would not know what was written.
        return await asyncio.shield(asyncio.create_task(self._write(), name="history"))

    async def _write(self) -> bool:
        async with self._writing:
            entries, dropped = tuple(self._waiting), self.dropped
            if not entries:
                return True
            try:
                await asyncio.get_running_loop().run_in_executor(self._thread, self._write_now, entries)
            except StoreError as error:
                if not self._problem:
                    LOG.error(  # noqa: TRY400
                        "%s; entries wait in memory until it can be written",
                        error,
                        extra={"event": "history"},
                    )
                self._problem = str(error)
                return False
            if self._problem:
                self._problem = ""
                LOG.info("%s is written again", self._path, extra={"event": "history"})
            for _ in range(len(entries) - (self.dropped - dropped)):
                self._waiting.popleft()
            if not self._waiting:
                self._filled.clear()
            return True

    def _write_now(self, entries: tuple[Entry, ...]) -> None:
        self._file = unless_gone(self._file, self._path)
        if self._file is None:
            self._file = HistoryFile(self._path)
        now = self._clock()
        self._file.write(entries, now)
        self._file.forget(now - self._settings.days * DAY, self._settings.max_mb * MB)
