"""Ends a task whose cancellation a library has swallowed."""

from __future__ import annotations

import asyncio
from collections.abc import Coroutine
from typing import Any, TypeVar

_Result = TypeVar("_Result")
_AGAIN = 0.05
"""Between two cancellations of what did not obey the first one, s; hardly any work needs a second."""


def obey_cancellation() -> None:
    """Raise CancelledError if this task was cancelled and a library kept that to itself.

    ``asyncio.wait_for`` of Python 3.11 does when its result comes at the same moment, and asyncua, pymodbus
    and aiomqtt wait with it. Every endless loop around them calls this, or it would never end.
    """
    task = asyncio.current_task()
    if task is not None and task.cancelling():
        raise asyncio.CancelledError


async def ends_when_cancelled(work: Coroutine[Any, Any, _Result]) -> _Result:
    """Run what waits several times within a library, and cancel it until it ends if this task is cancelled.

    Where the first of its waits swallows the cancellation, the next one would last for its whole timeout.
    """
    task = asyncio.ensure_future(work)
    try:
        result = await asyncio.shield(task)
    except asyncio.CancelledError:
        while not task.done():
            task.cancel()
            await asyncio.wait({task}, timeout=_AGAIN)
        if not task.cancelled():
            task.exception()  # the caller has gone: nobody else takes it out
        raise
    obey_cancellation()
    return result
