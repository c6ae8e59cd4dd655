"""Gathers samples into minutes and writes them to the file; reading samples never waits for it."""

from __future__ import annotations

import asyncio
import logging
import math
from collections import deque
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING, NoReturn

import numpy as np

from agent.runtime.intake.window import LAST_TIME
from agent.runtime.samples.minute import MINUTE, OpenMinute
from agent.runtime.samples.sample_file import SampleFile, SampleGap
from agent.runtime.store.database import StoreError, unless_gone
from connectors.cancellation import obey_cancellation

if TYPE_CHECKING:
    from pathlib import Path

    from agent.runtime.intake.rows import ValueRows
    from connectors.base import Sample

LOG = logging.getLogger(__name__)
LOOK = 2.0
"""Time between two looks for minutes that are over, s."""
QUIET = 15.0
"""A minute is over when nothing came for it so long, s: a bus may send role after role. What comes later
makes another row of the same minute."""
AT_A_TIME = 2
"""Minutes of a loop that may be open; another one closes the oldest."""
LIMIT = 40_000
"""Minutes that may wait in memory, some 60 MB; beyond it the oldest are discarded, and a gap is marked."""
MB = 1e6
"""bytes"""


class SampleRecorder:
    """``put`` takes samples in the event loop; ``run`` is for a supervisor."""

    def __init__(self, path: Path, max_mb: float) -> None:
        """Make it; nothing is opened yet.

        Args:
            path: Of the file.
            max_mb: Size of the file, MB.
        """
        self._path, self._max_mb = path, max_mb
        self._open: dict[str, list[OpenMinute]] = {}
        self._over: deque[OpenMinute] = deque()
        self._gap: SampleGap | None = None
        self._problem = ""
        self._file: SampleFile | None = None
        self._writing = asyncio.Lock()
        self._thread = ThreadPoolExecutor(1, thread_name_prefix="samples")

    def put(self, sample: Sample, arrival: float) -> None:
        """Take a sample that arrived at ``arrival`` (monotonic, s); one without a time is left out."""
        if not abs(sample.time) <= LAST_TIME:
            return
        loop = sample.tag.loop
        self._minute(loop, math.floor(sample.time / MINUTE)).put(sample, arrival)
        self._close_oldest(loop)

    def take(self, loop: str, rows: ValueRows) -> None:
        """Take rows of a loop, all good and with times that are believed, as ``put`` does one by one."""
        numbers = np.floor(rows.times.source / MINUTE).astype(np.int64)
        firsts = np.flatnonzero(np.append([True], numbers[1:] != numbers[:-1])).tolist()
        for first, end in zip(firsts, [*firsts[1:], len(numbers)], strict=True):
            self._minute(loop, int(numbers[first])).take(rows, slice(first, end))
            self._close_oldest(loop)

    def _minute(self, loop: str, number: int) -> OpenMinute:
        """Return the open minute of this number, begun where there is none."""
        minutes = self._open.setdefault(loop, [])
        for minute in minutes:
            if minute.number == number:
                return minute
        minutes.append(OpenMinute(loop, number))
        return minutes[-1]

    def _close_oldest(self, loop: str) -> None:
        minutes = self._open[loop]
        if len(minutes) > AT_A_TIME:
            oldest = min(minutes, key=lambda each: each.number)
            minutes.remove(oldest)
            self._close(oldest)

    async def run(self) -> NoReturn:
        """Write what is over, until cancelled."""
        while True:
            await asyncio.sleep(LOOK)
            self._close_before(asyncio.get_running_loop().time() - QUIET)
            await self._flush()
            obey_cancellation()

    async def close(self) -> None:
        """Write all, also minutes that are not over, and let go of the file."""
        self._close_before(math.inf)
        await self._flush()
        if self._file is not None:
            await asyncio.get_running_loop().run_in_executor(self._thread, self._file.close)
        self._thread.shutdown(wait=False)

    def _close_before(self, arrival: float) -> None:
        for minutes in self._open.values():
            for minute in [each for each in minutes if each.touched < arrival]:
                minutes.remove(minute)
                self._close(minute)

    def _close(self, minute: OpenMinute) -> None:
        self._over.append(minute)
        if len(self._over) > LIMIT:
            lost = float(self._over.popleft().number * MINUTE)
            self._gap = _joined(SampleGap(lost, lost, 1), self._gap)

    async def _flush(self) -> None:
        # A task of its own: a caller cancelled during the wait would not know what was written.
        await asyncio.shield(asyncio.create_task(self._write(), name="samples"))

    async def _write(self) -> None:
        async with self._writing:
            minutes, self._over = self._over, deque()
            gap, self._gap = self._gap, None
            if not minutes and gap is None:
                return
            try:
                await asyncio.get_running_loop().run_in_executor(self._thread, self._write_now, minutes, gap)
            except StoreError as error:
                if not self._problem:
                    text = "%s; samples wait in memory until it can be written"
                    LOG.error(text, error, extra={"event": "history"})  # noqa: TRY400
                self._problem = str(error)
                self._take_back(minutes, gap)
                return
            if self._problem:
                self._problem = ""
                LOG.info("%s is written again", self._path, extra={"event": "history"})

    def _take_back(self, minutes: deque[OpenMinute], gap: SampleGap | None) -> None:
        """Put what could not be written before what came meanwhile."""
        later, self._over = self._over, minutes
        self._gap = gap if self._gap is None else _joined(self._gap, gap)
        for minute in later:
            self._close(minute)

    def _write_now(self, minutes: deque[OpenMinute], gap: SampleGap | None) -> None:
        self._file = unless_gone(self._file, self._path)
        if self._file is None:
            self._file = SampleFile(self._path)
        self._file.write(minutes, gap)
        self._file.forget(self._max_mb * MB)


def _joined(gap: SampleGap, other: SampleGap | None) -> SampleGap:
    if other is None:
        return gap
    since, until = min(gap.since, other.since), max(gap.until, other.until)
    return SampleGap(since, until, gap.minutes + other.minutes)
