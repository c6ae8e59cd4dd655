"""A loop over many models, cut into slices that run at the same time; how many changes no result.

The kernels release the lock of the interpreter, so threads run them on several cores. A process that has the
machine to itself takes all cores (``on_cores``); one of several that share it takes one, the default.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from contextvars import ContextVar
from itertools import pairwise

FEWEST = 32
"""Models in a slice, at least: they take about a quarter of a millisecond, to hand over a slice 0.05."""

_threads: ContextVar[tuple[int, ThreadPoolExecutor | None]] = ContextVar("threads", default=(1, None))


@contextmanager
def on_cores(count: int) -> Iterator[None]:
    """Let the loops within run on ``count`` cores."""
    if count < 2:
        yield
        return
    with ThreadPoolExecutor(count - 1, "slices") as pool:
        before = _threads.set((count, pool))
        try:
            yield
        finally:
            _threads.reset(before)


def in_slices(work: Callable[[int, int], None], first: int, last: int) -> None:
    """Do the work from ``first`` up to ``last``, in slices on the cores that there are.

    Args:
        work: Does a part, from its first argument up to its second; parts do not depend on each other.
        first: Where it begins.
        last: Where it ends.
    """
    cores, pool = _threads.get()
    slices = min(cores, (last - first) // FEWEST)
    if pool is None or slices < 2:
        work(first, last)
        return
    ends = [first + (last - first) * k // slices for k in range(slices + 1)]
    others = [pool.submit(work, begin, end) for begin, end in pairwise(ends[1:])]
    work(ends[0], ends[1])
    for each in others:
        each.result()
