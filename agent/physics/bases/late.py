"""A position behind a dead time."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]


def late(position: FloatArray, delay: float, ts: float) -> FloatArray:
    """Return what drives a process from each sample to the next, (n,), the unit of ``position``.

    ``delay``: dead time plus the sample for which a position is held, s, at least one sample.
    """
    at = np.arange(len(position), dtype=np.float64)
    return np.asarray(np.interp(at - (max(delay / ts, 1.0) - 1.0), at, position), dtype=np.float64)
