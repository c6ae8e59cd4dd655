"""When simulated time comes in wall time."""

from __future__ import annotations

import asyncio

SLACK = 0.1
"""Lateness that is caught up with, s of wall time; what goes beyond shifts all that follows."""


class Clock:
    """Simulated time in step with the event loop's clock, times a factor.

    The first wait ties the two together. Who comes late is not made to wait and nothing is ever skipped;
    much lateness is not made up for by a burst either, the clock falls behind instead.
    """

    def __init__(self, factor: float | None) -> None:
        """Run ``factor`` times as fast as the wall, > 0; None: flat out."""
        if factor is not None and factor <= 0:
            raise ValueError(f"factor must be > 0, got {factor:g}")
        self._factor = factor
        self._offset: float | None = None

    async def wait_until(self, time: float) -> None:
        """Return when simulated ``time`` (s) has come, at once where it has passed; others get a turn."""
        if self._factor is None:
            await asyncio.sleep(0)
            return
        now = asyncio.get_running_loop().time()
        due = time / self._factor
        if self._offset is None:
            self._offset = now - due
        early = due + self._offset - now
        self._offset += max(-early - SLACK, 0.0)
        await asyncio.sleep(max(early, 0.0))
