"""The heap of a daemon that runs for months: it returns memory, and is not searched as a whole.

glibc gives each thread a heap of its own, and keeps what is free at the end of one, the more the larger the
largest block that was ever freed. Both let the daemon grow by MB an hour (docs/reliability.md, "Days").
"""

from __future__ import annotations

import asyncio
import contextlib
import ctypes
import gc
import os
from typing import NoReturn

_SETTINGS = {"MALLOC_ARENA_MAX": (-8, 1), "MALLOC_TRIM_THRESHOLD_": (-1, 131072)}
"""Each with its number in malloc.h and its value: one heap; bytes, the default, but it stays once set."""

APART = 30.0
"""Time between two looks at what was made since, s: first values, diagnoses."""
LOOKS = 120
"""After so many, an hour, all of it is searched: only that finds what a lost session leaves behind."""


def keep_one_heap() -> None:
    """Configure the allocator of this process and its children, unless the environment sets it.

    It has no effect without glibc.
    """
    with contextlib.suppress(OSError, AttributeError, TypeError):  # no C library of that kind
        mallopt = ctypes.CDLL(None).mallopt
        for name, (number, value) in _SETTINGS.items():
            if name not in os.environ:
                mallopt(number, value)
                os.environ[name] = str(value)


def settle() -> None:
    """Take what there is now out of the search for garbage; call it when all loops are made.

    A search through the objects of 10,000 loops stops the event loop for 0.6 s, again and again, and a broker
    or a queue then loses messages. What loops and connections leave when they are replaced is still freed
    where nothing refers to it; the rest of it at the next call.
    """
    gc.unfreeze()
    gc.collect()
    gc.freeze()


def set_aside() -> None:
    """Take what was made since ``settle`` out of the search as well; this takes no time.

    First values and diagnoses of 10,000 loops are made after the start; a search through them stops the event
    loop for a sixth of a second, whenever it comes, as in a scrape.
    """
    gc.freeze()


async def keep_settled() -> NoReturn:
    """Set aside what is new twice a minute, and settle once an hour; for a supervisor."""
    while True:
        for _ in range(LOOKS):
            await asyncio.sleep(APART)
            set_aside()
        settle()
