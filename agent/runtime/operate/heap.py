"""One heap that returns memory: a daemon that runs for months must not keep the most it ever needed.

glibc gives each thread a heap of its own, and keeps what is free at the end of one, the more the larger the
largest block that was ever freed. Both let the daemon grow by MB an hour (docs/reliability.md, "Days").
"""

from __future__ import annotations

import contextlib
import ctypes
import os

_SETTINGS = {"MALLOC_ARENA_MAX": (-8, 1), "MALLOC_TRIM_THRESHOLD_": (-1, 131072)}
"""Each with its number in malloc.h and its value: one heap; bytes, the default, but it stays once set."""


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
