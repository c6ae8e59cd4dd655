"""The processes of this machine: the default place of a survey."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Generator, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, wait
from concurrent.futures.process import BrokenProcessPool
from itertools import islice
from typing import TypeVar

from agent.runtime.loop.process_pool import end_workers, process_pool
from agent.runtime.survey.executor import Done, fault_of

T = TypeVar("T")
R = TypeVar("R")
AHEAD = 1
"""Tasks beyond one a worker that are handed out, so that no worker waits; all of them are done again where a
process dies."""
DIED = "its process was ended, for want of memory or by somebody"


class LocalProcesses:
    """A pool of processes that end with this one."""

    def __init__(self, workers: int, ready: Callable[..., object] | None = None, *args: object) -> None:
        """Make it.

        Args:
            workers: How many.
            ready: As of ``process_pool``.
            args: As of ``process_pool``.
        """
        self._workers = workers
        self._ready, self._args = ready, args

    def results(self, function: Callable[[T], R], tasks: Iterable[T]) -> Iterator[Done[T, R]]:
        """Yield the end of each task; see ``BatchExecutor``.

        Nobody knows which task a dead process worked on: those that were handed out are repeated, each in a
        process of its own, and what dies there has failed.
        """
        coming = iter(tasks)
        suspects: deque[T] = deque()
        while True:
            if suspects:
                task = suspects.popleft()
                died = yield from self._batch(function, iter((task,)), 1)
                if died:
                    yield Done(task, None, DIED)
                continue
            suspects.extend((yield from self._batch(function, coming, self._workers)))
            if not suspects:
                return

    def _batch(
        self, function: Callable[[T], R], coming: Iterator[T], workers: int
    ) -> Generator[Done[T, R], None, list[T]]:
        """Work until there is no task, or a process died; return the tasks that were handed out then."""
        running: dict[Future[R], T] = {}
        pool = process_pool(workers, self._ready, *self._args)
        try:
            while True:
                for task in islice(coming, workers + AHEAD - len(running)):
                    try:
                        running[pool.submit(function, task)] = task
                    except BrokenProcessPool:
                        return [*running.values(), task]
                if not running:
                    return []
                ready, _ = wait(running, return_when=FIRST_COMPLETED)
                broken = [future for future in ready if isinstance(future.exception(), BrokenProcessPool)]
                for future in ready.difference(broken):
                    yield _done(running.pop(future), future)
                if broken:
                    return list(running.values())
        finally:
            if running:  # somebody interrupted us: nobody waits for these any more
                pool.shutdown(wait=False, cancel_futures=True)
                end_workers()
            pool.shutdown()


def _done(task: T, future: Future[R]) -> Done[T, R]:
    error = future.exception()
    return Done(task, future.result()) if error is None else Done(task, None, fault_of(error))
