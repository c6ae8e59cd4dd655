"""The physical quantities (axes) against which a residual is tested.

Each axis uses only the past: a reversal of OP counts from the sample on at which it exceeds the noise. OP
reacts to the residual, so an axis that used a later reversal would contain the residual, too.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.record.reversals import NOISES, op_noise

if TYPE_CHECKING:
    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]

UNITS = {
    "travel_since_reversal": "OP",
    "direction": "-1 closing, 1 opening",
    "op_level": "OP",
    "op_rate": "OP/s",
    "valve_position": "OP",
    "oscillation_phase": "periods since OP reversed upward",
    "time": "s",
    "time_of_day": "h",
    "set_point": "PV",
}
"""Of each axis."""
OF_TIME = frozenset({"time", "time_of_day"})
"""Axes that do not depend on OP."""
LEAST_PART_OF_SPAN = 0.01
"""Part of OP's span that a reversal must exceed as well as the noise, which a coarse resolution may hide."""
RATE_PART = 0.05
"""Part of a period over which the rate of OP is taken: less is noise, more is the level."""
DAY = 86400.0
DAYS = 2.0
"""In fewer the time of day is the time."""


def physical_axes(
    op: FloatArray,
    ts: float,
    period: float,
    *,
    position: FloatArray | None = None,
    set_point: FloatArray | None = None,
    start: float = 0.0,
) -> dict[str, FloatArray]:
    """Return the axes that the record has, each (n,), in ``UNITS``, NaN where unknown.

    Args:
        op: Without gaps, OP units, (n,), n >= 2.
        ts: s.
        period: Dominant period of OP, samples.
        position: Of the model's valve, OP units, (n,); None where it has no valve effect.
        set_point: PV units, (n,); None where it was not recorded.
        start: Time of the first sample, s UTC.
    """
    turn, direction = last_turns(op, max(NOISES * op_noise(op), LEAST_PART_OF_SPAN * float(np.ptp(op))))
    known = turn >= 0
    seconds = ts * np.arange(len(op))
    axes = {
        "travel_since_reversal": np.where(known, np.abs(op - op[turn]), np.nan),
        "direction": np.where(known, direction, np.nan),
        "op_level": op,
        "op_rate": _rate(op, ts, max(1, round(RATE_PART * period))),
        "oscillation_phase": _phase(turn, direction, period),
        "time": seconds,
    }
    if position is not None:
        axes["valve_position"] = position
    if seconds[-1] > DAYS * DAY:
        axes["time_of_day"] = (start + seconds) % DAY / 3600.0
    if set_point is not None and np.nanmin(set_point) < np.nanmax(set_point):
        axes["set_point"] = set_point
    return axes


def last_turns(op: FloatArray, least: float) -> tuple[NDArray[np.int64], FloatArray]:
    """Return for each sample the last reversal of OP, and the direction since: 1 up, -1 down.

    Args:
        op: OP units, (n,), no NaN.
        least: OP has reversed when it has moved back by more than this, OP units.

    Returns:
        Sample of the reversal, (n,), -1 before the first; direction, (n,), 0 before the first.
    """
    turns = np.full(len(op), -1)
    directions = np.zeros(len(op))
    low = high = 0
    turn, direction = -1, 0
    for t, value in enumerate(op.tolist()):
        low = t if value <= op[low] else low
        high = t if value >= op[high] else high
        if direction <= 0 and value - op[low] > least:
            turn, direction, high = low, 1, t
        elif direction >= 0 and op[high] - value > least:
            turn, direction, low = high, -1, t
        turns[t], directions[t] = turn, direction
    return turns, directions


def _rate(op: FloatArray, ts: float, over: int) -> FloatArray:
    """Return the mean rate over the last ``over`` samples, OP units per second, (n,)."""
    rate = np.full(len(op), np.nan)
    rate[over:] = (op[over:] - op[:-over]) / (over * ts)
    return rate


def _phase(turn: NDArray[np.int64], direction: FloatArray, period: float) -> FloatArray:
    """Return the time since OP last reversed upward in dominant periods, at most 1, (n,)."""
    at = np.arange(len(turn))
    low = np.maximum.accumulate(np.where(direction > 0, turn, -1))
    return np.where(low >= 0, np.minimum((at - low) / period, 1.0), np.nan)
