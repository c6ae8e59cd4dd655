"""The unit in which the time of a record is read best."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]

TIME_UNITS = (
    (3 * 86400.0, 86400.0, "days"),
    (3 * 3600.0, 3600.0, "h"),
    (600.0, 60.0, "min"),
    (0.0, 1.0, "s"),
)
"""Records longer than the first number (s) are drawn in units of the second, named by the third."""


def time_of(samples: int, ts: float) -> tuple[FloatArray, str]:
    """Return the times from the start of a record, (samples,), and their unit; ``ts`` in s."""
    scale, unit = next((scale, unit) for least, scale, unit in TIME_UNITS if samples * ts > least)
    return np.asarray(ts * np.arange(samples) / scale, dtype=np.float64), unit
