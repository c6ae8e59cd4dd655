"""A linear process of gain one: dead time, lags, perhaps an integrator or a first move the wrong way."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from agent.jit import kernel
from agent.physics.processes.fopdt import fopdt
from agent.physics.processes.integrator import integrator

if TYPE_CHECKING:
    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class LinearProcess:
    """Between valve position and PV."""

    delay: float
    """Dead time plus the sample for which a position is held, s, at least one sample."""
    lags: tuple[float, ...] = ()
    """Time constants, s, > 0."""
    integrates: bool = False
    lead: float = 0.0
    """Time constant of a first move the wrong way: the response loses this times its own speed, s."""

    def respond(self, position: FloatArray, ts: float) -> FloatArray:
        """Return the deviation of PV for gain one, (n,), in OP units (integrating: OP units times s).

        From rest at the first position; an integrator stands still at the mean position.

        Args:
            position: OP units, (n,), no NaN.
            ts: s.
        """
        response = np.empty_like(position)
        delay = max(self.delay / ts, 1.0)
        lags = list(self.lags)
        if self.integrates or not lags:
            integrator(position, float(np.mean(position)), delay, response)
            response *= ts
        else:
            fopdt(position, float(position[0]), lags.pop(0) / ts, delay, response)
        for lag in lags:
            response = lagged(response, lag / ts)
        if self.lead > 0.0:
            response = response - self.lead * np.gradient(response, ts)
        return response


@kernel
def lagged(signal: FloatArray, tau: float) -> FloatArray:
    """Return ``signal`` (n,) behind a first-order lag of ``tau`` samples, from rest.

    Exact for a signal that goes in straight lines from sample to sample (first-order hold).
    """
    out = np.empty(signal.size)
    if tau <= 0.0:
        out[:] = signal
        return out
    keep = math.exp(-1.0 / tau)
    mean = tau * (1.0 - keep)  # weight of the older end of a line, before it fades
    y = signal[0] if signal.size else 0.0
    for t in range(signal.size):
        if t > 0:
            y = keep * y + (mean - keep) * signal[t - 1] + (1.0 - mean) * signal[t]
        out[t] = y
    return out
