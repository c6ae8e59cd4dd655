"""Ends a read after too long a silence."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager

RESOLUTION = 1e-3
"""s"""


@asynccontextmanager
async def unless_silent(longest: float | None) -> AsyncIterator[Callable[[], None]]:
    """Yield a function to call at each sign of life; raises TimeoutError ``longest`` s after the last call.

    The function only reads the clock: a timer for each of thousands of calls a second would be expensive.
    With None there is no limit.
    """
    clock = asyncio.get_running_loop()
    heard = clock.time()

    def sign() -> None:
        nonlocal heard
        heard = clock.time()

    async with asyncio.timeout(None) as silence:
        if longest is None:
            yield sign
            return

        timer: asyncio.TimerHandle

        def look() -> None:
            nonlocal timer
            if clock.time() < heard + longest - RESOLUTION:
                timer = clock.call_at(heard + longest, look)
            else:
                silence.reschedule(clock.time())

        timer = clock.call_at(heard + longest, look)
        try:
            yield sign
        finally:
            timer.cancel()
