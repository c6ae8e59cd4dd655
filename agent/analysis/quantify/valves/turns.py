"""Reversals of a valve: without one a record does not show stiction, because any S fits with some process."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray


def turns(position: FloatArray) -> int:
    """Count the changes of direction of a stem; position in OP units, (n,), without gaps."""
    directions = np.sign(np.diff(position))
    directions = directions[directions != 0]
    return int(np.count_nonzero(np.diff(directions)))
