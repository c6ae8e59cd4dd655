"""Slow air supply: the actuator follows OP behind a first-order lag."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from agent.jit import kernel
from agent.physics.effect import Facts, Parameter, Stage

FloatArray = NDArray[np.float64]


@kernel
def lagged(command: FloatArray, tau: float, ts: float) -> FloatArray:
    """Return what follows a command (n,) behind a lag of ``tau`` s, at the end of each sample of ``ts`` s.

    Exact for a command that is held meanwhile; before the first sample all is at rest.
    """
    if tau <= 0.0:
        return command.copy()
    keep = math.exp(-ts / tau)
    followed, deviation = np.empty(command.size), 0.0
    for t in range(command.size):
        deviation = (1.0 - keep) * (command[t] - command[0]) + keep * deviation
        followed[t] = command[0] + deviation
    return followed


@dataclass(frozen=True, slots=True)
class ActuatorLag:
    """A first-order lag before the stem."""

    name: str = "actuator_lag"
    family: str = "extra_lag"
    stage: Stage = "valve"
    bases: tuple[str, ...] = ()

    def parameters(self, facts: Facts) -> tuple[Parameter, ...]:
        """Return the time constant."""
        return (Parameter("tau", "s", 0.0, facts.period, null=0.0),)

    def apply(self, position: FloatArray, values: FloatArray, ts: float) -> FloatArray:
        """Return where the actuator is at the end of each sample."""
        return lagged(position, float(values[0]), ts)
