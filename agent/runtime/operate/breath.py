"""Work on all loops that lets others have their turn: the event loop that reads must not stand still."""

from __future__ import annotations

import asyncio
import time
from collections.abc import AsyncIterator, Iterable
from typing import TypeVar

T = TypeVar("T")
AT_ONCE = 0.005
"""Longest time that such work takes before others have their turn, s."""


async def breathing(each: Iterable[T]) -> AsyncIterator[T]:
    """Yield each; other tasks have their turn whenever that took ``AT_ONCE``."""
    began = time.perf_counter()
    for one in each:
        yield one
        if time.perf_counter() - began > AT_ONCE:
            await asyncio.sleep(0)
            began = time.perf_counter()
