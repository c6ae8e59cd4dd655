"""Several tests at once: Holm's step-down adjustment.

Source: S. Holm, "A simple sequentially rejective multiple test procedure", Scand. J. Statist. 6 (1979) 65.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]

LEVEL = 0.05
"""Significant below it."""


def holm(p: FloatArray) -> FloatArray:
    """Return adjusted p-values (m,): those below a level may be rejected together at that level.

    The smallest of ``p`` (m,) is multiplied by m, the next by m - 1, and none comes out below one before it.
    """
    order = np.argsort(p, kind="stable")
    stepped = np.maximum.accumulate(p[order] * np.arange(len(p), 0, -1))
    adjusted = np.empty(len(p))
    adjusted[order] = np.minimum(stepped, 1.0)
    return adjusted
