"""Times of day and elapsed times without a date: 08:00:05, 0 days 00:00:05."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from connectors.exports.tables.sheet import FloatArray

DAY = 86400.0
WRITTEN = re.compile(
    r"(?:(?P<days>\d{1,5})(?:\s*(?:days?|d)[ ,]\s*|\.))?(?P<h>\d{1,4}):(?P<m>[0-5]\d):(?P<s>[0-5]\d)"
    r"(?:[.,](?P<f>\d{1,9}))?(?:\s*(?P<half>[AaPp])\.?\s?[Mm]\.?)?"
)
"""Two numbers (08:00) may be hours and minutes or minutes and seconds: they are no time here."""


def days_and_clock(cell: str) -> float | None:
    """Return the seconds of a time of day or an elapsed time, or None where a cell is neither."""
    found = WRITTEN.fullmatch(cell.strip().strip("'\""))
    if found is None:
        return None
    hour = int(found["h"])
    if found["half"]:
        if not 1 <= hour <= 12:
            return None
        hour = hour % 12 + (12 if found["half"] in "pP" else 0)
    fraction = float(f"0.{found['f']}") if found["f"] else 0.0
    return int(found["days"] or 0) * DAY + hour * 3600.0 + int(found["m"]) * 60.0 + int(found["s"]) + fraction


def over_midnight(seconds: FloatArray) -> FloatArray:
    """Return times of day as a count that rises over midnight, s, shape (n,); NaN stays.

    A step of more than half a day back is midnight, forward (newest first) likewise. Other steps back stay:
    the reader refuses them.
    """
    counted = np.array(seconds)
    known = np.flatnonzero(np.isfinite(seconds))
    steps = np.diff(seconds[known])
    turns = np.where(
        steps < -DAY / 2, 1.0, np.where((steps > DAY / 2) & (seconds[known][1:] < DAY), -1.0, 0.0)
    )
    counted[known[1:]] += DAY * np.cumsum(turns)
    return counted
