"""Timestamped rows onto a uniform time grid; where nothing was recorded there is NaN."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from agent.analysis.record.recording import FloatArray

LONGEST = 10_000_000
"""Grid points beyond which the timestamps, not the memory, must be wrong."""


@dataclass(frozen=True, slots=True)
class UniformGrid:
    """Columns at ``start + k ts``, each of shape (n,)."""

    start: float
    """Time of the first point, s."""
    ts: float
    """Sampling time, s."""
    columns: Mapping[str, FloatArray]
    duplicates: int
    """Rows dropped because an earlier row had their place on the grid."""


def uniform_grid(time: ArrayLike, columns: Mapping[str, ArrayLike], ts: float | None = None) -> UniformGrid:
    """Put rows on the uniform grid through the first of them.

    Args:
        time: Times of the rows, s, shape (m,), never decreasing.
        columns: Values by name, each of shape (m,).
        ts: Sampling time, s; None takes the usual step between the rows.

    Returns:
        The grid. A row goes to the nearest point, so jitter of up to half a step does no harm. Of rows that
        share a point the first is kept.

    Raises:
        ValueError: A time is not finite or less than the one before (names the index), there is no row,
            ``ts`` is not positive, or a jump in time would make the grid absurdly long.
    """
    times = np.asarray(time, dtype=np.float64)
    if times.size == 0:
        raise ValueError("there are no rows")
    if not np.isfinite(times).all():
        raise ValueError(f"time is not a finite number at index {np.flatnonzero(~np.isfinite(times))[0]}")
    steps = np.diff(times)
    if (steps < 0).any():
        raise ValueError(f"time runs backward at index {np.flatnonzero(steps < 0)[0] + 1}")
    step = _usual_step(steps) if ts is None else ts
    if not step > 0:
        raise ValueError(f"the sampling time must be positive, not {step}")
    slots = np.rint((times - times[0]) / step)
    if slots[-1] >= LONGEST:
        raise ValueError(f"{times[-1] - times[0]:g} s at {step:g} s a sample is more than {LONGEST} samples")
    places, first = np.unique(slots.astype(np.int64), return_index=True)
    return UniformGrid(
        start=float(times[0]),
        ts=float(step),
        columns={name: _placed(values, places, first) for name, values in columns.items()},
        duplicates=int(times.size - places.size),
    )


def _usual_step(steps: FloatArray) -> float:
    """Mean of the steps that are one sample long, s; 1 where there is no step at all.

    The median finds them; their mean is finer than the median, whose rounding would add up over the record.
    """
    forward = steps[steps > 0]
    if forward.size == 0:
        return 1.0
    median = np.sort(forward)[(forward.size - 1) // 2]
    single = forward[np.abs(forward / median - 1) < 0.5]
    return float(f"{single.mean() if single.size else median:.7g}")


def _placed(values: ArrayLike, places: NDArray[np.int64], first: NDArray[np.intp]) -> FloatArray:
    column = np.full(places[-1] + 1, np.nan)
    column[places] = np.asarray(values, dtype=np.float64)[first]
    return column
