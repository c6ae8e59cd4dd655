"""Integrator plus dead time: dy/dt = position(t - delay) - level."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from agent.jit import kernel
from agent.physics.processes.dead_time import split_delay

if TYPE_CHECKING:
    from numpy.typing import NDArray


@kernel
def integrator(position: NDArray[np.float64], level: float, delay: float, out: NDArray[np.float64]) -> None:
    """Write the response of slope one into ``out``, exact for a position that is held between samples.

    The process is at rest, at zero, before the first sample. A NaN position makes all that follows NaN.
    Source: zero-order-hold equivalent (see ``dead_time``); docs/methods/integrator.md.

    Args:
        position: Valve position, OP units, shape (n,).
        level: Position at which PV is constant, OP units; the mean position keeps the numbers small.
        delay: Samples, >= 1, may have a fraction; y(t) depends first on position(t - floor(delay)).
        out: Response, OP units times samples, shape (n,).
    """
    whole, part = split_delay(delay)
    y = newer = 0.0
    for t in range(position.size):
        older = newer
        if t >= whole:
            newer = position[t - whole] - level
        y += part * older + (1.0 - part) * newer
        out[t] = y
