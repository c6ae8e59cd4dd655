"""A moving mass with viscous and Coulomb friction behind dead time, which may be integrated to a place.

    tau dv/dt = u - v - F sign(v);  v = 0 while |u| <= F

Solved exactly in each sample, for a drive held from sample to sample.
Source: C. Canudas de Wit et al., A new model for control of systems with friction, IEEE Trans. Automat.
Contr. 40 (1995) 419, its static limit.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np
from scipy.integrate import cumulative_trapezoid

from agent.jit import kernel
from agent.physics.bases.late import late
from agent.physics.bases.linear_process import NO_LAG, LinearProcess, lagged

if TYPE_CHECKING:
    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]


@kernel
def speeds(drive: FloatArray, tau: float, friction: float) -> FloatArray:
    """Return the speed (n,) for a ``drive`` (n,) about zero, same unit; ``tau`` in samples."""
    found = np.empty(drive.size)
    first = drive[0]
    v = math.copysign(max(abs(first) - friction, 0.0), first)
    for t in range(drive.size):
        found[t] = v
        u, left = drive[t], 1.0
        if v != 0.0:
            end = u - math.copysign(friction, v)
            if end * v < 0.0:
                stops = tau * math.log((v - end) / -end)
                if stops < left:
                    left -= stops
                    v = 0.0
            if v != 0.0:
                v = end + (v - end) * math.exp(-left / tau)
                left = 0.0
        if v == 0.0 and left > 0.0 and abs(u) > friction:
            v = (u - math.copysign(friction, u)) * -math.expm1(-left / tau)
    return found


@dataclass(frozen=True, slots=True)
class SlidingProcess(LinearProcess):
    """The same with friction on what its longest lag moves; a lead or creep is not kept."""

    superposes: ClassVar[bool] = False
    friction: float = 0.0
    """F, OP units."""
    no_drive: float = 0.0
    """OP that drives nothing, OP units."""

    def respond(self, position: FloatArray, ts: float) -> FloatArray:
        """Return the speed, counted from ``no_drive``, or its integral, for gain one, (n,)."""
        *others, longest = sorted((NO_LAG, *(lag / ts for lag in self.lags)))
        speed = speeds(late(position, self.delay, ts) - self.no_drive, longest, self.friction)
        for tau in others:
            speed = lagged(speed, tau if tau > NO_LAG else 0.0)
        if self.integrates:
            return np.asarray(cumulative_trapezoid(speed - speed.mean(), dx=ts, initial=0))
        return np.asarray(self.no_drive + speed)
