"""Processes that work for a program and end with it, however it ends."""

from __future__ import annotations

import multiprocessing
import os
import threading
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from typing import Any

from agent.runtime.capabilities import cores, start_method

CONTEXT: Any = multiprocessing.get_context(start_method())
"""Workers come from a process that has no threads, event loop or sockets; a plain fork would copy ours."""


def process_pool(
    workers: int | None = None, ready: Callable[..., object] | None = None, *args: object
) -> ProcessPoolExecutor:
    """Return a pool none of whose processes outlives this one, not even where SIGKILL ends it.

    Args:
        workers: How many processes; None: one for each core that this one may use.
        ready: Prepares each of them; it and its arguments are pickled, so it is a module-level function.
        args: Its arguments.
    """
    count = cores() if workers is None else workers
    return ProcessPoolExecutor(count, CONTEXT, _begin, (ready, args))


def _begin(ready: Callable[..., object] | None, args: tuple[object, ...]) -> None:
    threading.Thread(target=_end_with_the_parent, name="watch the parent", daemon=True).start()
    if ready is not None:
        ready(*args)


def _end_with_the_parent() -> None:
    """Wait for the end of the program, which SIGKILL gives no time to end its workers.

    The fork server is the parent in the sense of the kernel, so PR_SET_PDEATHSIG would not work; it ends when
    its last worker does.
    """
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)
