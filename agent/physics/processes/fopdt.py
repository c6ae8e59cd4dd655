"""First-order lag plus dead time: tau dy/dt = position(t - delay) - y."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from agent.jit import kernel
from agent.physics.processes.dead_time import split_delay

if TYPE_CHECKING:
    from numpy.typing import NDArray


@kernel
def fopdt(
    position: NDArray[np.float64], level: float, tau: float, delay: float, out: NDArray[np.float64]
) -> None:
    """Write the response of gain one into ``out``, exact for a position that is held between samples.

    PV rests at position(0) before the first sample. A NaN position makes all that follows it NaN.
    Source: zero-order-hold equivalent (see ``dead_time``); docs/methods/fopdt.md derives it.

    Args:
        position: Valve position, OP units, shape (n,).
        level: Position from which response and ``out`` are counted, OP units.
        tau: Time constant, samples, > 0.
        delay: Samples, >= 1, may have a fraction; y(t) depends first on position(t - floor(delay)).
        out: Response minus ``level``, OP units, shape (n,).
    """
    whole, part = split_delay(delay)
    keep = math.exp(-1.0 / tau)
    from_newer = -math.expm1(-(1.0 - part) / tau)
    from_older = 1.0 - keep - from_newer
    y = newer = position[0] - level if position.size else 0.0
    for t in range(position.size):
        older = newer
        if t >= whole:
            newer = position[t - whole] - level
        y = keep * y + from_older * older + from_newer * newer
        out[t] = y
