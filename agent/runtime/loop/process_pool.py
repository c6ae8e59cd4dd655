"""Processes that work for a program and end with it, however it ends."""

from __future__ import annotations

import gc
import multiprocessing
import os
import sys
import threading
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from typing import Any, TypeVar

from agent.runtime.capabilities import cores, import_before_start, start_method

CONTEXT: Any = multiprocessing.get_context(start_method())
"""Workers come from a process that has no threads, event loop or sockets; a plain fork would copy ours."""

NO_COUNT = "ignore:resource_tracker"
"""Python's tracker removes what a killed program leaves, and warns on its terminal; it starts with our
options for warnings, and need not say that."""
UNCOLLECTED = "agent.runtime.uncollected"
"""Stops the search for garbage where it is imported."""

T = TypeVar("T")
R = TypeVar("R")


def results_of(
    function: Callable[[T], R],
    tasks: Sequence[T],
    workers: int,
    ready: Callable[..., object] | None = None,
    *args: object,
) -> Iterator[R | None]:
    """Yield the result of each task in order; None where its process died (out of memory, or killed).

    Nobody knows which task a dead process worked on. Those that may have run are repeated one by one, each in
    a process of its own; the others go on together.

    Args:
        function: Module-level; what it returns is never None.
        tasks: Its arguments.
        workers: How many processes.
        ready: As of ``process_pool``.
        args: As of ``process_pool``.
    """
    waiting, alone = deque(tasks), 0
    while waiting:
        batch = [waiting[0]] if alone else [*waiting]
        with process_pool(1 if alone else workers, ready, *args) as pool:
            for future in [pool.submit(function, task) for task in batch]:
                try:
                    result: R | None = future.result()
                except BrokenProcessPool:
                    if not alone:
                        alone = min(len(waiting), workers + 1)  # a pool hands out one task ahead
                        break
                    result = None
                waiting.popleft()
                alone = max(alone - 1, 0)
                yield result


def process_pool(
    workers: int | None = None, ready: Callable[..., object] | None = None, *args: object
) -> ProcessPoolExecutor:
    """Return a pool none of whose processes outlives this one, not even where SIGKILL ends it.

    Args:
        workers: How many processes; None: one for each core that this one may use.
        ready: Prepares each of them; it and its arguments are pickled, so it is a module-level function.
        args: Its arguments.
    """
    _count_in_silence()
    count = cores() if workers is None else workers
    return ProcessPoolExecutor(count, CONTEXT, _begin, (ready, args))


def import_early(modules: Sequence[str]) -> None:
    """Let all workers find modules imported from now on, while this process goes on."""
    _count_in_silence()
    import_before_start(CONTEXT, [UNCOLLECTED, *modules])


def end_workers() -> None:
    """Kill every worker of this program, whatever it does."""
    for process in multiprocessing.active_children():
        if isinstance(process, CONTEXT.Process):
            process.kill()


def _count_in_silence() -> None:
    if NO_COUNT not in sys.warnoptions:
        sys.warnoptions.append(NO_COUNT)


def _begin(ready: Callable[..., object] | None, args: tuple[object, ...]) -> None:
    threading.Thread(target=_end_with_the_parent, name="watch the parent", daemon=True).start()
    if ready is not None:
        ready(*args)
    gc.freeze()  # what was imported stays: a collection that searches it costs time and copies its pages
    gc.enable()


def _end_with_the_parent() -> None:
    """Wait for the end of the program, which SIGKILL gives no time to end its workers.

    The fork server is the parent in the sense of the kernel, so PR_SET_PDEATHSIG would not work; it ends when
    its last worker does.
    """
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)
