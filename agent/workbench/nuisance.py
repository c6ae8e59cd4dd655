"""Parts of PV that belong to no effect: level, slow drift, and a transient at the start of the record.

If a model lacks them, a slow effect may fit the drift by chance: reference ``missing_effect.md`` 2.2, where
an offset absorbed half of an asymmetric friction.
"""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from agent.workbench.record import Record

    FloatArray = NDArray[np.float64]

SLOWEST = 5.0
"""Drift is slower than so many dominant periods."""
MOST_WAVES = 6
"""More would follow every load step."""


def nuisance_of(record: Record) -> FloatArray:
    """Return the columns of ``nuisance`` and those of OP before the record, (n, k)."""
    columns = nuisance(len(record), record.period)
    return columns if record.start is None else np.column_stack((columns, record.start))


@lru_cache(maxsize=16)
def nuisance(samples: int, period: float) -> FloatArray:
    """Return level, slope, a decay of one period and slow cosines as columns, (samples, k), read only.

    Args:
        samples: Of the record.
        period: Dominant period, samples.
    """
    at = np.arange(samples) + 0.5
    waves = np.arange(1, 1 + min(MOST_WAVES, int(2 * samples / (SLOWEST * period))))
    cosines = np.cos(np.pi * np.outer(at / samples, waves))
    columns = np.column_stack((np.ones(samples), at / samples - 0.5, np.exp(-at / period), cosines))
    columns.flags.writeable = False
    return columns
