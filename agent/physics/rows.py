"""Signals of many models: a row for each, or one row that all share."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from agent.jit import kernel


@kernel
def row_of(signals: NDArray[np.float64], model: int) -> NDArray[np.float64]:
    """Return the signal, (n,), of a model by its number: a row of (m, n), or the only one of (1, n)."""
    row: NDArray[np.float64] = signals[min(model, len(signals) - 1)]
    return row
