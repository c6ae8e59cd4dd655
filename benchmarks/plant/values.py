"""Values of a plant: most loops have noise alone, each tenth swings, all set points stand."""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

ROLES = ("op", "pv", "sp")
SWINGS_OF = 10
"""Of so many loops one swings: a third of a plant's loops is what surveys report, most of them by little."""
PERIOD = 30.0
"""Of the swing, s."""
NOISE = 0.3
"""Standard deviation, % of the span."""


@lru_cache(maxsize=4)
def values_at(second: float, loops: int) -> NDArray[np.float64]:
    """Return OP, PV and SP of each loop, shape (loops, 3); not to be written to."""
    number = np.arange(loops)
    phase = 2 * math.pi * second / PERIOD + number
    swing = np.where(number % SWINGS_OF == 0, 1.0, 0.0)
    table = np.full((loops, len(ROLES)), 50.0)
    table[:, :2] += NOISE * np.random.default_rng(int(second)).standard_normal((loops, 2))
    table[:, 0] += 3 * swing * np.cos(phase) - 10
    table[:, 1] += 5 * swing * np.sin(phase)
    return table
