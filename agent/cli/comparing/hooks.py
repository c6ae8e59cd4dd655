"""Hooks of a session on a terminal: all cores, and a line of progress on stderr."""

from __future__ import annotations

import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from agent.cli.common.compilation import announce_compilation

if TYPE_CHECKING:
    from agent.workbench.hooks import Map


@contextmanager
def pool_of_cores() -> Iterator[Map]:
    """Yield a map that works on all cores."""
    from agent.runtime.capabilities import cores

    workers = cores()
    if workers == 1:
        announce_compilation(threading.Event())
        yield map
        return
    from agent.runtime.loop.process_pool import CONTEXT, import_early, process_pool

    import_early(["agent.workbench.session"])
    announced = CONTEXT.Event()
    announce_compilation(announced)
    with process_pool(workers, announce_compilation, announced) as pool:
        yield pool.map


class TerminalProgress:
    """Names on a terminal's stderr what is being tried; nothing where stderr is no terminal.

    The bar is redrawn by a thread of its own and erases the line of the cursor each time: it rests while a
    user types, and while lines are printed.
    """

    def __init__(self) -> None:
        """Prepare a bar that is not shown yet."""
        from rich.console import Console
        from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

        columns = (
            TextColumn("trying {task.description:24}"),
            BarColumn(),
            MofNCompleteColumn(),
            TimeElapsedColumn(),
        )
        self._silent = not sys.stderr.isatty()
        self._bar = Progress(*columns, console=Console(stderr=True), redirect_stdout=False, transient=True)
        self._work = self._bar.add_task("", total=1)
        self._shown = False

    def __call__(self, what: str, done: int, of: int, /) -> None:
        """Show what is being tried."""
        if self._silent:
            return
        if not self._shown:
            self._bar.reset(self._work)
            self._bar.start()
            self._shown = True
        self._bar.update(self._work, description=what.replace("_", " "), completed=done, total=of)

    def rest(self) -> None:
        """Take the bar away until something is tried again."""
        if self._shown:
            self._bar.stop()
            self._shown = False


@contextmanager
def progress_on_terminal() -> Iterator[TerminalProgress]:
    """Name on a terminal's stderr what is being tried."""
    progress = TerminalProgress()
    try:
        yield progress
    finally:
        progress.rest()
