"""First-order lag behind a dead time, of a signal that goes in straight lines from sample to sample."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from agent.jit import kernel
from agent.physics.processes.dead_time import split_delay

if TYPE_CHECKING:
    from numpy.typing import NDArray


@kernel
def lag_of_lines(
    signal: NDArray[np.float64], level: float, tau: float, delay: float, out: NDArray[np.float64]
) -> None:
    """Write the response into ``out``; before the first sample the signal rests there.

    The late signal is read between samples on the line through them, and goes in straight lines from there
    again. Source: first-order-hold equivalent (Astrom and Wittenmark, Computer-Controlled Systems, 3rd ed.,
    1997, problem 2.13).

    Args:
        signal: Its own unit, (n,).
        level: From which the response is counted.
        tau: Time constant, samples; 0 or less: none.
        delay: Samples, >= 0, may have a fraction.
        out: Response minus ``level``, (n,).
    """
    whole, part = split_delay(delay)
    keep = math.exp(-1.0 / tau) if tau > 0.0 else 0.0
    older_end = tau * (1.0 - keep) if tau > 0.0 else 0.0  # its weight before it fades
    first = signal[0] if signal.size else 0.0
    y = late = 0.0
    for t in range(signal.size):
        before = late
        newer = signal[t - whole] - first if t >= whole else 0.0
        older = signal[t - whole - 1] - first if t > whole else 0.0
        late = newer + part * (older - newer)
        y = keep * y + (1.0 - older_end) * late + (older_end - keep) * before
        out[t] = y + (first - level)
