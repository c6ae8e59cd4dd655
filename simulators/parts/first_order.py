"""First-order balances that are not linear: a vessel that radiates, a drive with Coulomb friction."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from agent.jit import kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]

STRIBECK, EXCESS = 0.05, 0.2
"""Speed over which friction falls as a drive begins to move, over the friction, and by which part of it."""


@kernel
def heated(inputs: FloatArray, level: float, step: float, absolute: float) -> FloatArray:
    """Temperature of a vessel that loses heat by the fourth power, deviation, unit of ``inputs``, (n,).

    Args:
        inputs: Heat held over each step, (n,).
        level: Temperature before the first step.
        step: dt / tau at the operating point.
        absolute: Temperature of the operating point above absolute zero, same unit.
    """
    outputs = np.empty(inputs.size)
    for i in range(inputs.size):
        level += step * (inputs[i] - 0.25 * absolute * ((1.0 + level / absolute) ** 4 - 1.0))
        outputs[i] = level
    return outputs


@kernel
def driven(inputs: FloatArray, speed: float, step: float, friction: float) -> FloatArray:
    """Speed of a mass with viscous and Coulomb friction, which is a little higher at rest, (n,).

    Args:
        inputs: Drive held over each step, about zero, (n,).
        speed: Before the first step.
        step: dt / tau.
        friction: Of the moving mass, unit of ``inputs``.
    """
    outputs = np.empty(inputs.size)
    for i in range(inputs.size):
        excess = EXCESS * math.exp(-((speed / (STRIBECK * friction)) ** 2))
        holds = friction * (1.0 + excess)
        if speed == 0.0:
            moves = math.copysign(max(abs(inputs[i]) - holds, 0.0), inputs[i])
            speed = step * moves
        else:
            after = speed + step * (inputs[i] - speed - math.copysign(holds, speed))
            speed = after if after * speed > 0.0 else 0.0
        outputs[i] = speed
    return outputs
