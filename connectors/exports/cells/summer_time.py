"""The hour that local time skips when summer time begins."""

from __future__ import annotations

from datetime import UTC, datetime
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from connectors.exports.tables.sheet import FloatArray

HOUR = 3600.0
SKIPPED = (1, 2)
"""Hours of a Sunday that Britain and the rest of Europe and of North America skip."""


def skipped_hour(local: FloatArray) -> datetime | None:
    """Return the first time after an hour that was skipped as where summer time begins; None where none was.

    Args:
        local: Times as written, s, (n,), rising or falling; NaN where a row has none.
    """
    times = np.unique(local[np.isfinite(local)])
    steps = np.diff(times)
    if not steps.size:
        return None
    usual = float(np.median(steps))
    for place in np.flatnonzero(np.abs(steps - HOUR - usual) <= usual / 2):
        before, after = (datetime.fromtimestamp(times[k], UTC) for k in (place, place + 1))
        if after.weekday() == 6 and before.hour + 1 in SKIPPED and after.hour == before.hour + 2:
            return after
    return None
