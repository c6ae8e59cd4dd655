"""Where a valve that slips once each way slips first."""

from __future__ import annotations

from agent.identify.arrays import FloatArray
from agent.jit import kernel


@kernel
def first_slip(op: FloatArray, s: float, up: float) -> tuple[float, float]:
    """Return the level of OP at the first slip and its direction.

    A valve that slips once each way goes on slipping upward where OP passes the level ``up``, and downward S
    below it, for as long as the record lasts.
    """
    for t in range(op.size):
        if op[t] > up:
            return up, 1.0
        if op[t] < up - s:
            return up - s, -1.0
    return up, 1.0
