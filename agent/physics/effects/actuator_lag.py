"""Air that takes its time: the actuator follows OP behind a first-order lag."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.signal import lfilter

from agent.physics.effect import Facts, Parameter, Stage

if TYPE_CHECKING:
    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]


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
        """Return where the actuator is at the end of each sample, exact for a command held meanwhile."""
        tau = float(values[0])
        if tau <= 0.0:
            return position
        keep = math.exp(-ts / tau)
        deviation = lfilter([1.0 - keep], [1.0, -keep], position - position[0])
        return np.asarray(position[0] + deviation)
