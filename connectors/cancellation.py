"""Ends a task whose cancellation a library has swallowed."""

from __future__ import annotations

import asyncio


def obey_cancellation() -> None:
    """Raise CancelledError if this task was cancelled and a library kept that to itself.

    ``asyncio.wait_for`` of Python 3.11 does when its result comes at the same moment, and asyncua, pymodbus
    and aiomqtt wait with it. Every endless loop around them calls this, or it would never end.
    """
    task = asyncio.current_task()
    if task is not None and task.cancelling():
        raise asyncio.CancelledError
