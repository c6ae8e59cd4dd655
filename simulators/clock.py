"""The wall time at which a simulated time is due."""

from __future__ import annotations

import asyncio

SLACK = 0.1
"""Largest lateness that is caught up, s of wall time; a larger one delays all that follows."""


class Clock:
    """Simulated time in step with the event loop's clock, times a factor.

    The first wait fixes the start. A late caller does not wait and nothing is skipped; a large lateness is
    not followed by a burst, the clock falls behind instead.
    """

    def __init__(self, factor: float | None) -> None:
        """Run ``factor`` times as fast as the wall, > 0; None: flat out."""
        if factor is not None and factor <= 0:
            raise ValueError(f"factor must be > 0, got {factor:g}")
        self._factor = factor
        self._offset: float | None = None

    def change(self, factor: float) -> None:
        """Go on at another factor, > 0, from the next wait."""
        self._factor = factor
        self._offset = None

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
