"""Work on all loops that lets others have their turn: the event loop that reads must not stand still."""

from __future__ import annotations

import asyncio
import time
from collections.abc import AsyncIterator, Callable, Iterable, Sequence
from heapq import merge
from typing import Any, TypeVar

T = TypeVar("T")
AT_ONCE = 0.005
"""Longest time that such work takes before others have their turn, s."""


RUN = 500
"""Things that are sorted at a time: some milliseconds, and less to merge than with shorter runs."""


async def breathing(each: Iterable[T]) -> AsyncIterator[T]:
    """Yield each; other tasks have their turn whenever that took ``AT_ONCE``."""
    began = time.perf_counter()
    for one in each:
        yield one
        if time.perf_counter() - began > AT_ONCE:
            await asyncio.sleep(0)
            began = time.perf_counter()


async def in_order(things: Sequence[T], key: Callable[[T], Any]) -> list[T]:
    """Return things as ``sorted`` does, in runs that are merged; other tasks have their turn meanwhile."""
    starts = range(0, len(things), RUN)
    runs = [sorted(things[start : start + RUN], key=key) async for start in breathing(starts)]
    return [each async for each in breathing(merge(*runs, key=key))]
