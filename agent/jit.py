"""One place that compiles the loops, so that every kernel has the same options and a type."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar, cast

import numba

F = TypeVar("F", bound=Callable[..., object])


def kernel(function: F) -> F:
    """Compile ``function`` with numba, cached on disk.

    Each kernel keeps a slow, obvious twin in ``tests/reference`` that it is compared with. No fastmath:
    NaN marks missing data and must stay NaN.
    """
    return cast("F", numba.njit(cache=True, nogil=True)(function))
