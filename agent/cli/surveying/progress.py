"""Progress of a survey: a bar on a terminal, else a line at each tenth."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from agent.cli.common.errors import complain

if TYPE_CHECKING:
    from rich.progress import TaskID

    from agent.runtime.survey.survey import Watcher

PARTS = 10
"""Lines of a stretch of work where nobody watches a bar."""


class _Bar:
    """Shows the progress on a terminal."""

    def __init__(self, progress: Progress) -> None:
        self._progress = progress
        self._work: TaskID | None = None

    def begins(self, work: str, total: int, done: int) -> None:
        self._work = self._progress.add_task(work, total=total, completed=done)

    def advances(self) -> None:
        if self._work is not None:
            self._progress.advance(self._work)

    def fault(self, line: str) -> None:
        self._progress.console.print(f"slipjump: {line}", markup=False, highlight=False)


class _Lines:
    """Writes the progress to a log."""

    def __init__(self) -> None:
        self._work, self._total, self._done = "", 0, 0

    def begins(self, work: str, total: int, done: int) -> None:
        self._work, self._total, self._done = work, total, done
        complain(f"{work}: {done} of {total} done")

    def advances(self) -> None:
        before, self._done = self._done, self._done + 1
        if self._done * PARTS // self._total > before * PARTS // self._total:
            complain(f"{self._work}: {self._done} of {self._total} done")

    def fault(self, line: str) -> None:
        complain(line)


@contextmanager
def progress() -> Iterator[Watcher]:
    """Show on stderr what a survey does."""
    if not sys.stderr.isatty():
        yield _Lines()
        return
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns, console=Console(stderr=True)) as bars:
        yield _Bar(bars)
