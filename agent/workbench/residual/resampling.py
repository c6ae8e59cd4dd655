"""A resampled series: it keeps the correlation over short times and has none with any other signal."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]


def resampled(values: FloatArray, block: int, rng: np.random.Generator) -> FloatArray:
    """Return a series (n,) of stretches of ``values`` (n,), ``block`` samples long, that begin anywhere.

    The end goes on at the beginning: the circular block bootstrap (Politis and Romano 1992).
    """
    n = len(values)
    starts = rng.integers(n, size=-(-n // block))
    taken: FloatArray = values[np.add.outer(starts, np.arange(block)).ravel()[:n] % n]
    return taken
