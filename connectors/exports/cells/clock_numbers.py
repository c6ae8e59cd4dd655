"""Times as numbers: seconds, an epoch in s, ms, us or ns, days of Excel, OLE or MATLAB."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from connectors.exports.tables.sheet import FloatArray

DAY = 86400.0
SHORTEST, LONGEST = 1e-4, DAY
"""Sampling times that a recording of a control loop may have, s."""
EXCEL_1970, MATLAB_1970 = 25569.0, 719529.0
"""Days from the origin of each count to 1970-01-01."""
EXCEL_DAYS = (25569.0, 73050.0)
"""1970 to 2100 as days since 1899-12-30."""
MATLAB_DAYS = (719529.0, 767010.0)
EPOCHS = (
    (1e8, 4.2e9, 1.0, "epoch_s"),
    (1e11, 4.2e12, 1e-3, "epoch_ms"),
    (1e14, 4.2e15, 1e-6, "epoch_us"),
    (1e17, 4.2e18, 1e-9, "epoch_ns"),
)
"""Lowest and highest value (1973 to 2103), seconds a unit, name."""
AS_DAYS_BELOW, AS_SECONDS_FROM = 0.01, 0.05
"""Step of numbers that may be days of Excel or seconds: below the first days (14 minutes), from the second on
seconds; between them both are likely."""
UNITS = {
    "s": 1.0, "sec": 1.0, "secs": 1.0, "second": 1.0, "seconds": 1.0, "sekunden": 1.0,
    "ms": 1e-3, "msec": 1e-3, "millis": 1e-3, "milliseconds": 1e-3,
    "us": 1e-6, "µs": 1e-6, "min": 60.0, "mins": 60.0, "minute": 60.0, "minutes": 60.0, "minuten": 60.0,
    "h": 3600.0, "hr": 3600.0, "hour": 3600.0, "hours": 3600.0, "d": DAY, "day": DAY, "days": DAY,
}  # fmt: skip
FORMATS = ("seconds", "epoch_s", "epoch_ms", "epoch_us", "epoch_ns", "excel", "matlab")
"""What ``--time-format`` takes beside a pattern of strptime."""


class UnclearTimeError(ValueError):
    """Numbers that may be times in two ways, or in none; the message says which option settles it."""


@dataclass(frozen=True, slots=True)
class TimeScale:
    """How numbers become seconds."""

    factor: float
    """s a unit."""
    offset: float
    """Added before the factor, in the unit."""
    name: str
    """One of ``FORMATS``, or the unit."""
    absolute: bool
    """Whether the result is s UTC (or local time), not a count from an unknown start."""

    def seconds(self, values: FloatArray) -> FloatArray:
        """Return seconds, shape (n,)."""
        return (values + self.offset) * self.factor


CLOCKS = {
    "seconds": TimeScale(1.0, 0.0, "seconds", absolute=False),
    **{name: TimeScale(factor, 0.0, name, absolute=True) for *_, factor, name in EPOCHS},
    "excel": TimeScale(DAY, -EXCEL_1970, "excel", absolute=True),
    "matlab": TimeScale(DAY, -MATLAB_1970, "matlab", absolute=True),
}


def clock_of(values: FloatArray, unit: str) -> TimeScale:
    """Return how a column of numbers counts time.

    Args:
        values: Finite numbers in the order of the file, shape (n,), n >= 1.
        unit: Of the header, such as ``ms`` or ``[min]``; empty where there is none.

    Raises:
        UnclearTimeError: No way of counting gives a likely sampling time, or two do.
    """
    steps = np.abs(np.diff(values))
    steps = steps[steps > 0]
    step = float(np.median(steps)) if steps.size else None
    middle = float(np.median(values))
    for low, high, _, name in EPOCHS:
        if low <= middle <= high and (name != "epoch_s" or not unit or unit_factor(unit) in {None, 1.0}):
            return _checked(CLOCKS[name], step, middle)
    factor = unit_factor(unit)
    if factor is not None and not _within(middle, EXCEL_DAYS):
        return _checked(TimeScale(factor, 0.0, unit, absolute=False), step, middle)
    if _within(middle, MATLAB_DAYS) and step is not None and step < AS_DAYS_BELOW:
        return _checked(CLOCKS["matlab"], step, middle)
    if _within(middle, EXCEL_DAYS) and step is not None and step < AS_SECONDS_FROM:
        if step >= AS_DAYS_BELOW and factor is None:
            raise UnclearTimeError(
                f"times near {middle:.6g} in steps of {step:.3g} may be days of Excel "
                f"({step * DAY:.3g} s a sample) or seconds: give --time-format excel or --time-format seconds"
            )
        return _checked(CLOCKS["excel" if factor in {None, DAY} else "seconds"], step, middle)
    return _checked(CLOCKS["seconds"], step, middle)


def unit_factor(unit: str) -> float | None:
    """Return seconds a unit, or None where the word is no unit of time."""
    return UNITS.get(re.sub(r"[\[\]().]", "", unit).strip().casefold())


def _within(value: float, bounds: tuple[float, float]) -> bool:
    return bounds[0] <= value <= bounds[1]


def _checked(clock: TimeScale, step: float | None, middle: float) -> TimeScale:
    if step is None or SHORTEST <= step * clock.factor <= LONGEST:
        return clock
    raise UnclearTimeError(
        f"times near {middle:.6g} in steps of {step:.3g} would be {step * clock.factor:.3g} s a sample as "
        f"{clock.name}, expected {SHORTEST:g} to {LONGEST:g} s: "
        f"give --time-format {' or '.join(FORMATS)}, or --ts SECONDS"
    )
