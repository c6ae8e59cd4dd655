"""Steps behind a lag, sample by sample."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from agent.jit import kernel

FloatArray = NDArray[np.float64]
OVER = 1e-18
"""Part of a step to come that no sum shows."""


@kernel
def lagged_steps(time: FloatArray, instants: FloatArray, tau: float) -> FloatArray:
    """Return steps of height one behind a lag.

    Args:
        time: s, (n,), evenly spaced.
        instants: Of the steps, s, (k,): zero up to it.
        tau: Time constant, s; 0: at once.

    Returns:
        1 - exp(-(t - instant) / tau), (k, n).
    """
    count = len(time)
    out = np.zeros((len(instants), count))
    keep = np.exp(-(time[1] - time[0]) / tau) if tau > 0.0 and count > 1 else 0.0
    for k in range(len(instants)):
        own, instant = out[k], instants[k]
        i = 0
        while i < count and time[i] <= instant:
            i += 1
        if i == count:
            continue
        left = np.exp(-(time[i] - instant) / tau) if tau > 0.0 else 0.0
        while i < count and left > OVER:
            own[i] = 1.0 - left
            left *= keep
            i += 1
        own[i:] = 1.0
    return out
