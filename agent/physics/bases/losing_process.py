"""A vessel whose losses are no straight line in what it holds, behind dead time: heat, pressure, a level.

    tau dx/dt = u - (exp(c x) - 1) / c

x and u are counted from a level of OP. The slope of the losses, exp(c x), divides the gain and the time
constant alike. With w = exp(-c x) the balance is linear,

    tau dw/dt = 1 - (1 + c u) w

so that it is solved exactly in each sample, for an input that is held from sample to sample.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from agent.jit import kernel
from agent.physics.bases.late import late
from agent.physics.bases.linear_process import NO_LAG, LinearProcess, lagged

if TYPE_CHECKING:
    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]

FLATTEST = 0.02
"""Least slope of the losses at which a record begins, over that at the level: without any nothing rests."""
LARGEST = 1e300
"""Of w: an input below any losses lets it grow without end."""


@kernel
def held(inputs: FloatArray, tau: float, curvature: float) -> FloatArray:
    """Return what is held at each sample, (n,), from rest at the first input, all from one level, same unit.

    Args:
        inputs: Held until the next sample, (n,).
        tau: Samples, > 0.
        curvature: c, over the unit of ``inputs``, not 0.
    """
    found = np.empty(inputs.size)
    first = max(1.0 + curvature * inputs[0], FLATTEST)
    above = -(first - 1.0) / first  # w - 1, which keeps its digits where c is small
    for t in range(inputs.size):
        found[t] = -math.log1p(above) / curvature
        moved = curvature * inputs[t]
        slope = 1.0 + moved
        passed = -math.expm1(-slope / tau) / slope if slope != 0.0 else 1.0 / tau
        above = min(above * math.exp(-slope / tau) - moved * passed, LARGEST)
    return found


@dataclass(frozen=True, slots=True)
class LosingProcess(LinearProcess):
    """The same with such losses of what its longest lag holds; it has a lag, and does not integrate."""

    superposes: ClassVar[bool] = False
    curvature: float = 0.0
    """c, 1/OP, not 0."""
    level: float = 0.0
    """OP at which the losses have a slope of one."""

    def counted_from(self, position: FloatArray) -> float:  # noqa: ARG002
        """Return the level of OP that the response is counted from, OP units."""
        return self.level

    def _behind(self, taus: list[float], position: FloatArray, ts: float) -> FloatArray:
        """Return the response behind these lags, samples, the shorter first."""
        *others, longest = taus or [NO_LAG]
        response = held(late(position, self.delay, ts) - self.level, longest, self.curvature)
        for tau in others:
            response = lagged(response, tau)
        return response

    def _speed(self, taus: list[float], response: FloatArray, position: FloatArray, ts: float) -> FloatArray:
        """Return the speed of the response, its unit per s: of the last lag, how far it is behind."""
        if len(taus) > 1:
            *others, last, longest = taus
            return (self._behind([*others, longest], position, ts) - response) / (last * ts)
        lost = np.expm1(self.curvature * response) / self.curvature
        came_in = late(position, self.delay + ts, ts) - self.level  # over the sample before
        return np.asarray((came_in - lost) / ((taus or [NO_LAG])[0] * ts), dtype=np.float64)
