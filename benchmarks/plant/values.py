"""Values of a plant: each loop swings a little, its set point stands."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

ROLES = ("op", "pv", "sp")


def values_at(second: float, loops: int) -> NDArray[np.float64]:
    """Return OP, PV and SP of each loop, shape (loops, 3)."""
    phase = 0.01 * second + np.arange(loops)
    table = np.full((loops, len(ROLES)), 50.0)
    table[:, 0] = 40 + 3 * np.cos(phase)
    table[:, 1] += 5 * np.sin(phase)
    return table
