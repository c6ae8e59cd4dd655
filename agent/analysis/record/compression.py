"""Whether a historian compressed a record: straight lines between few kept points.

N. F. Thornhill, M. A. A. Shoukat Choudhury, S. L. Shah (2004), Journal of Process Control 14:389: a record
that was rebuilt by straight lines has second differences of zero but at the kept points. The compression
factor is the number of samples over the number of those that are not on a line; above 3 the shapes that
stiction leaves are lost.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray

DESTROYS = 3.0
"""Compression factor from which nonlinearity cannot be judged (Thornhill 2004, section 5)."""
LEAST = 50
"""Samples below which no factor is estimated."""
ROUNDING = 2.5
"""Second differences up to so many steps of the last digit may be zero, rounded."""
VISIBLE = 10.0
"""Typical first difference, in steps of the last digit, below which rounding hides what is straight."""


def compression_factor(values: FloatArray) -> float | None:
    """Return the factor by which straight lines were drawn through a record; 1 is raw.

    Args:
        values: One signal on a uniform grid, shape (n,), NaN where it is missing.

    Returns:
        The factor, >= 1, or None where the record is short, stands still, or is rounded too coarsely.
    """
    steps = np.diff(values)
    turns = np.diff(steps)
    moving = np.isfinite(turns) & ((steps[1:] != 0) | (steps[:-1] != 0))
    if np.count_nonzero(moving) < LEAST:
        return None
    digit = _last_digit(values[np.isfinite(values)])
    typical = float(np.median(np.abs(steps[1:][moving])))
    if digit > 0 and typical < VISIBLE * digit:
        return None
    tolerance = max(ROUNDING * digit, 1e-9 * float(np.nanmax(np.abs(values))))
    straight = np.count_nonzero(np.abs(turns[moving]) <= tolerance)
    return float(np.count_nonzero(moving)) / max(float(np.count_nonzero(moving) - straight), 1.0)


def _last_digit(values: FloatArray) -> float:
    """Return the value of the last decimal digit that a record has, 0 where it has many."""
    for decimals in range(7):
        if np.allclose(
            values, np.round(values, decimals), rtol=0, atol=1e-9 * max(1.0, float(np.max(np.abs(values))))
        ):
            return float(10.0**-decimals)
    return 0.0
