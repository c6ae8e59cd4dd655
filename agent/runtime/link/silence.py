"""Ends what listens when it has heard nothing for too long."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager

RESOLUTION = 1e-3
"""s"""


@asynccontextmanager
async def unless_silent(longest: float | None) -> AsyncIterator[Callable[[], None]]:
    """Yield what is to be called at each sign of life; raises TimeoutError ``longest`` s after the last.

    A sign of life only looks at the clock: setting a timer for each of thousands a second would be dear. With
    None it waits for ever.
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
