"""Times as numbers: seconds, an epoch in s, ms, us or ns, days of Excel, OLE or MATLAB."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from connectors.exports.tables.sheet import FloatArray

DAY = 86400.0
SHORTEST, LONGEST = 5e-3, DAY
"""Sampling times that a recording of a control loop may have where nobody states a unit, s. Below it days
since the start of the record are as likely (60 s are 0.0007 days, 5 minutes 0.0035), so that steps must be
even, for digits may have been cut off, and no sampling time that historians have in another unit."""
COMMON_FROM = 0.2
"""Sampling time up to which a number that is not round counts as minutes or hours, s (10 s: 0.1667 min)."""
PLAIN_LONGEST = 1000.0
"""Sampling time from which numbers without a unit may as well be milliseconds (of 1 s and more), s."""
MOST_EXACT = 1e-5
"""Relative difference from a round number up to which a step counts as round; exports have six digits."""
MOSTLY = 0.99
"""Part of the steps that are near their median where no digits were cut off."""
COMMON = tuple(
    [each / 100 for each in (10, 20, 25, 50)]
    + [1, 2, 2.5, 3, 4, 5, 6, 10, 12, 15, 20, 25, 30, 40, 50]
    + [60 * each for each in (1, 1.5, 2, 3, 4, 5, 6, 10, 12, 15, 20, 30, 60, 90, 120, 240, 360, 720, 1440)]
)
"""Sampling times that historians have, s: what another unit must make of a step to be likelier than seconds.
Rigs are sampled at rates of any three digits, 500 Hz or 51200 Hz: no such times in minutes, hours or days."""
FIRST, LAST = 1990, 2050
"""Years in which an absolute time may lie; they keep all ways of counting apart."""
EXCEL_1970, MATLAB_1970 = 25569.0, 719529.0
"""Days from the origin of each count to 1970-01-01."""
WINDOWS_1970, DOTNET_1970, LABVIEW_1970 = 11644473600.0, 62135596800.0, 2082844800.0
"""Seconds from 1601, from year 1 and from 1904 to 1970-01-01."""
AS_DAYS_BELOW, AS_SECONDS_FROM = 0.01, 0.05
"""Step of numbers that may be days of Excel or seconds: below the first days (14 minutes), from the second on
seconds; between them both are likely."""
UNITS = {
    "s": 1.0, "sec": 1.0, "secs": 1.0, "second": 1.0, "seconds": 1.0, "sekunden": 1.0,
    "ms": 1e-3, "msec": 1e-3, "millis": 1e-3, "milliseconds": 1e-3,
    "us": 1e-6, "µs": 1e-6, "ns": 1e-9,
    "min": 60.0, "mins": 60.0, "minute": 60.0, "minutes": 60.0, "minuten": 60.0,
    "h": 3600.0, "hr": 3600.0, "hour": 3600.0, "hours": 3600.0, "d": DAY, "day": DAY, "days": DAY,
}  # fmt: skip


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


ELAPSED = {
    name: TimeScale(factor, 0.0, name, absolute=False)
    for name, factor in (
        ("seconds", 1.0),
        ("ms", 1e-3),
        ("us", 1e-6),
        ("min", 60.0),
        ("h", 3600.0),
        ("days", DAY),
    )
}
"""Counts from an unknown start."""
ABSOLUTE = {
    "ticks": TimeScale(1e-7, -DOTNET_1970 * 1e7, "ticks", absolute=True),  # before 1990 as an epoch in ns
    "filetime": TimeScale(1e-7, -WINDOWS_1970 * 1e7, "filetime", absolute=True),
    "epoch_s": TimeScale(1.0, 0.0, "epoch_s", absolute=True),
    "epoch_ms": TimeScale(1e-3, 0.0, "epoch_ms", absolute=True),
    "epoch_us": TimeScale(1e-6, 0.0, "epoch_us", absolute=True),
    "epoch_ns": TimeScale(1e-9, 0.0, "epoch_ns", absolute=True),
    "labview": TimeScale(1.0, -LABVIEW_1970, "labview", absolute=True),
    "excel": TimeScale(DAY, -EXCEL_1970, "excel", absolute=True),
    "matlab": TimeScale(DAY, -MATLAB_1970, "matlab", absolute=True),
}
"""Dates as numbers: since 1970 (epoch), of Windows, .NET and LabVIEW, days of Excel (and OLE) and MATLAB."""
CLOCKS = ELAPSED | ABSOLUTE
FORMATS = tuple(CLOCKS)
"""What ``--time-format`` takes beside a pattern of strptime."""


def clock_of(values: FloatArray, unit: str) -> TimeScale:
    """Return how a column of numbers counts time.

    A way of counting is admitted where the dates lie in ``FIRST`` to ``LAST`` and the sampling time is one
    that recordings have; nothing is admitted that a second way explains as well.

    Args:
        values: Finite numbers in the order of the file, shape (n,), n >= 1.
        unit: Of the header, such as ``ms`` or ``[min]``; empty where there is none.

    Raises:
        UnclearTimeError: No way of counting gives a likely sampling time, or two do.
    """
    every = np.abs(np.diff(values))
    steps = every[every > 0]
    step = float(np.median(steps)) if steps.size else None
    middle = float(np.median(values))
    factor = unit_factor(unit)
    for name, scale in ABSOLUTE.items():
        if not _in_years(scale, middle) or (name in {"epoch_s", "labview"} and factor not in {None, 1.0}):
            continue
        if scale.factor != DAY:
            return _checked(scale, step, middle)
        if factor in {None, DAY} and step is not None and step < AS_SECONDS_FROM:
            if step >= AS_DAYS_BELOW and factor is None:
                raise _days_or_seconds(middle, step, name)
            return _checked(scale, step, middle)
    if factor is not None:
        return TimeScale(factor, 0.0, unit, absolute=False)
    if step is not None:
        _refuse_unlikely(step, every, middle)
    return CLOCKS["seconds"]


def unit_factor(unit: str) -> float | None:
    """Return seconds a unit, or None where the word is no unit of time."""
    return UNITS.get(re.sub(r"[\[\]().]", "", unit).strip().casefold())


def _in_years(scale: TimeScale, value: float) -> bool:
    first, last = ((year - 1970) * 365.2425 * DAY for year in (FIRST, LAST))
    return first <= (value + scale.offset) * scale.factor <= last


def _days_or_seconds(middle: float, step: float, name: str) -> UnclearTimeError:
    return UnclearTimeError(
        f"times near {middle:.6g} in steps of {step:.4g} may be days ({step * DAY:.3g} s a sample) "
        f"or seconds: give --time-format {name} or --time-format seconds"
    )


def _checked(clock: TimeScale, step: float | None, middle: float) -> TimeScale:
    """Return a clock; raises UnclearTimeError where its sampling time is none of a recording."""
    if step is None or 1e-2 * SHORTEST <= step * clock.factor <= LONGEST:
        return clock
    raise UnclearTimeError(
        f"times near {middle:.6g} in steps of {step:.4g} would be {step * clock.factor:.4g} s a sample as "
        f"{clock.name}: give --time-format {', '.join(FORMATS)} or a pattern, or --ts SECONDS"
    )


def _refuse_unlikely(step: float, steps: FloatArray, middle: float) -> None:
    """Raise UnclearTimeError where numbers without a unit are hardly seconds.

    Args:
        step: The median of the steps.
        steps: From one to the next, (n,).
        middle: Of the numbers.
    """
    regular = steps[np.abs(steps / step - 1) < 0.5]
    mean = float(np.mean(regular))
    exact = max(MOST_EXACT, float(np.ptp(regular)) / (len(regular) * mean))  # digits may have been cut off
    others = [
        (name, scale)
        for name, scale in ELAPSED.items()
        if name != "seconds"
        and SHORTEST <= step * scale.factor <= LONGEST
        and any(abs(mean * scale.factor / each - 1) < exact for each in COMMON)
    ]
    if step < SHORTEST:
        even = len(regular) >= MOSTLY * len(steps)
        likely = even and not others
    else:
        likely = step < PLAIN_LONGEST and (step >= COMMON_FROM or _is_round(mean) or not others)
    if likely:
        return
    looks = " or ".join(f"{name} ({mean * scale.factor:.4g} s a sample)" for name, scale in others)
    seems = f", look like {looks}" if looks else ""
    options = " or ".join(f"--time-format {name}" for name in ("seconds", *(name for name, _ in others)))
    raise UnclearTimeError(
        f"times near {middle:.6g} in steps of {step:.4g} would be {step:.4g} s a sample as seconds{seems}: "
        f"give {options}, or --ts SECONDS"
    )


def _is_round(seconds: float) -> bool:
    """Whether a sampling time is one that people set: three digits, no more."""
    return abs(float(f"{seconds:.3g}") / seconds - 1) < MOST_EXACT
