"""Hooks of a session on a terminal: all cores, and a line of progress on stderr."""

from __future__ import annotations

import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from agent.cli.common.compilation import announce_compilation

if TYPE_CHECKING:
    from agent.workbench.hooks import Map, Progress


@contextmanager
def pool_of_cores() -> Iterator[Map]:
    """Yield a map that works on all cores."""
    from agent.runtime.capabilities import cores, import_before_start

    workers = cores()
    if workers == 1:
        announce_compilation(threading.Event())
        yield map
        return
    from agent.runtime.loop.process_pool import CONTEXT, process_pool

    import_before_start(CONTEXT, ["agent.workbench.session"])
    announced = CONTEXT.Event()
    announce_compilation(announced)
    with process_pool(workers, announce_compilation, announced) as pool:
        yield pool.map


@contextmanager
def progress_on_terminal() -> Iterator[Progress]:
    """Name on a terminal's stderr what is being tried."""
    from agent.workbench.hooks import silent

    if not sys.stderr.isatty():
        yield silent
        return
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

    columns = (
        TextColumn("trying {task.description:24}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
    )
    console = Console(stderr=True)
    with Progress(*columns, console=console, redirect_stdout=False, transient=True) as progress:
        work = progress.add_task("", total=1)

        def shown(what: str, done: int, of: int, /) -> None:
            progress.update(work, description=what.replace("_", " "), completed=done, total=of)

        yield shown
