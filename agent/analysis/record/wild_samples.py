"""Isolated samples far outside those around them, as transmitters and gateways send them for one scan.

A process has a lag and a valve has a range: neither leaves what it did just before and does just after, for
one or two samples, by many times what it moves there. Values such as 1e6, -999, 65535 or 0 do, also those
within the range of the whole record, where it begins at rest or the set point moved. They are gaps, as values
too large for any plant are; one of them would else decide a fit by squares.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]

LONGEST_RUN = 2
"""Samples in a row: a scan, or one that two samples hold."""
BESIDE = 3
"""Samples on each side that a sample is compared with; more than ``LONGEST_RUN``, so that they outvote it."""
SUDDEN = 20.0
"""Typical steps between samples by which a sample that may be wild stands off its neighbours."""
OUTSIDE = 5.0
"""Largest steps among the samples around it (``BESIDE`` on each side) by which it is outside their range."""
VISIBLE = 0.25
"""Part of the usual range of the whole signal (5 to 95 %) by which it does; less does no harm."""
MOST = 0.02
"""Share of the samples up to which they are single events; more of them are a signal of their own."""


def wild(values: FloatArray) -> NDArray[np.bool_]:
    """Return which samples are wild, shape (n,).

    Args:
        values: One signal on a uniform grid, shape (n,), NaN where it is missing.
    """
    none = np.zeros(len(values), np.bool_)
    finite = np.isfinite(values)
    if np.count_nonzero(finite) < 4 * BESIDE:
        return none
    steps = np.abs(np.diff(values[finite]))
    typical = float(np.median(steps[steps > 0])) if (steps > 0).any() else 0.0
    suspect = np.zeros(len(values), np.bool_)
    places = _near_large_steps(np.flatnonzero(finite), steps, SUDDEN * typical / BESIDE)
    suspect[places] = np.abs(values[places] - _beside(values, places)) > SUDDEN * typical
    suspect &= _short_runs(suspect)
    rest = values[finite & ~suspect]
    if not suspect.any() or not rest.size or np.ptp(rest) <= 0:
        return none
    usual = float(np.diff(np.quantile(rest, (0.05, 0.95)))[0])
    least = max(SUDDEN * typical, VISIBLE * usual)
    found = np.zeros(len(values), np.bool_)
    calm = np.flatnonzero(finite & ~suspect)
    for k in np.flatnonzero(suspect).tolist():
        place = int(np.searchsorted(calm, k))
        one_sided = place in {0, calm.size}  # at an end it may belong to a level before or behind
        around = rest if one_sided else values[calm[max(place - BESIDE, 0) : place + BESIDE]]
        out = max(float(around.min()) - values[k], values[k] - float(around.max()))
        moved = (
            float(np.ptp(rest)) if one_sided else OUTSIDE * float(np.abs(np.diff(around)).max(initial=0.0))
        )
        found[k] = out > max(least, moved)
    return found if np.count_nonzero(found) <= max(1.0, MOST * np.count_nonzero(finite)) else none


def _near_large_steps(finite: NDArray[np.intp], steps: FloatArray, large: float) -> NDArray[np.intp]:
    """Return the samples that have a step above ``large`` among those to the samples they are compared with.

    Others are at most ``BESIDE`` times as far from their neighbours.

    Args:
        finite: Samples that are not missing, (f,).
        steps: Sizes of the steps between these, (f - 1,).
        large: Unit of the signal.
    """
    near = np.zeros(len(finite), np.bool_)
    for k in np.flatnonzero(steps > large).tolist():
        near[max(k + 1 - BESIDE, 0) : k + 1 + BESIDE] = True
    return finite[near]


def _beside(values: FloatArray, places: NDArray[np.intp]) -> FloatArray:
    """Return the median of the samples on both sides of some, (k,); NaN where there are none."""
    padded = np.concatenate([np.full(BESIDE, np.nan), values, np.full(BESIDE, np.nan)])
    shifts = np.array([k for k in range(2 * BESIDE + 1) if k != BESIDE])
    around = np.sort(padded[places[:, None] + shifts], axis=1)  # NaN last
    count = np.count_nonzero(np.isfinite(around), axis=1)
    row = np.arange(len(places))
    middle = (around[row, (count - 1) // 2] + around[row, count // 2]) / 2
    return np.where(count > 0, middle, np.nan)


def _short_runs(marked: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return which marks stand in runs of at most ``LONGEST_RUN``, shape (n,)."""
    edges = np.flatnonzero(np.diff(np.concatenate(([False], marked, [False]))))
    short = np.zeros(len(marked), np.bool_)
    for begin, end in zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True):
        short[begin:end] = end - begin <= LONGEST_RUN
    return short
