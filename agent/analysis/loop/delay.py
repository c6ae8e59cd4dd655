"""Time delay of an oscillating process: Lee, Ren and Huang (2008), section II.

A step of the input shows in PV after the delay, so the increments of both correlate most at that lag. For a
second-order process the second differences do. On the input of a sticking valve this fails (a change of OP
moves nothing); on the position of the valve it works.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray


def estimate_delay(u: FloatArray, y: FloatArray, *, order: int, longest: int) -> int | None:
    """Return the delay, samples, 1 to ``longest``; None where nothing correlates or the record is too short.

    The lag of the largest |R(tau)|, R(tau) = sum over t of U(t) Y(t + tau), with U and Y the differences of
    the given order. (The paper prints the sum over tau, a misprint.) Products with a missing sample are left
    out.

    Args:
        u: Input, OP units, shape (n,).
        y: Output, PV units, shape (n,).
        order: 1 for a first-order process, 2 for a second-order one.
        longest: Last lag to try, samples.
    """
    du, dy = np.diff(u, order), np.diff(y, order)
    lags = range(1, min(longest, len(du) - 1) + 1)
    correlation = [abs(np.nansum(du[:-lag] * dy[lag:])) for lag in lags]
    if not correlation or max(correlation) == 0:
        return None
    return int(np.argmax(correlation)) + 1
