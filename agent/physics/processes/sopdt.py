"""Two first-order lags in a row plus dead time."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from agent.jit import kernel
from agent.physics.processes.dead_time import split_delay

if TYPE_CHECKING:
    from numpy.typing import NDArray


@kernel
def passed_on(slow: float, fast: float, duration: float) -> float:
    """Return the part of the slow lag's deviation that is in the fast lag after ``duration``.

    slow (exp(-duration / slow) - exp(-duration / fast)) / (slow - fast), written so that equal time constants
    are a special case only for 0/0.
    """
    gap = duration * (slow - fast) / (slow * fast)
    share = -math.expm1(-gap) / gap if gap > 0.0 else 1.0
    return math.exp(-duration / slow) * share * duration / fast


@kernel
def sopdt(
    position: NDArray[np.float64],
    level: float,
    tau: float,
    tau2: float,
    delay: float,
    out: NDArray[np.float64],
) -> None:
    """Write the response of gain one into ``out``, exact for a position that is held between samples.

    Both lags rest at position(0) before the first sample. A NaN position makes all that follows it NaN.
    Source: zero-order-hold equivalent (see ``dead_time``); docs/methods/sopdt.md derives it.

    Args:
        position: Valve position, OP units, shape (n,).
        level: Position from which response and ``out`` are counted, OP units.
        tau: Time constant, samples, > 0.
        tau2: The other one, samples, > 0; which is the longer does not matter.
        delay: Samples, >= 1, may have a fraction; y(t) depends first on position(t - floor(delay)).
        out: Response minus ``level``, OP units, shape (n,).
    """
    whole, part = split_delay(delay)
    slow = max(tau, tau2)
    fast = min(tau, tau2)
    rest = 1.0 - part
    keep_slow = math.exp(-1.0 / slow)
    keep_fast = math.exp(-1.0 / fast)
    slow_from_newer = -math.expm1(-rest / slow)
    slow_from_older = 1.0 - keep_slow - slow_from_newer
    fast_from_slow = passed_on(slow, fast, 1.0)
    fast_from_newer = -math.expm1(-rest / fast) - passed_on(slow, fast, rest)
    fast_from_older = 1.0 - keep_fast - fast_from_slow - fast_from_newer
    first = y = newer = position[0] - level if position.size else 0.0
    for t in range(position.size):
        older = newer
        if t >= whole:
            newer = position[t - whole] - level
        y = keep_fast * y + fast_from_slow * first + fast_from_older * older + fast_from_newer * newer
        first = keep_slow * first + slow_from_older * older + slow_from_newer * newer
        out[t] = y
