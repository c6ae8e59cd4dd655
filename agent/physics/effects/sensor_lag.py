"""Transmitter or filter with a lag."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from agent.physics.bases.linear_process import lagged
from agent.physics.effect import Facts, Parameter, Stage

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class SensorLag:
    """A first-order lag between PV and its measured value."""

    name: str = "sensor_lag"
    family: str = "extra_lag"
    stage: Stage = "sensor"
    bases: tuple[str, ...] = ()

    def parameters(self, facts: Facts) -> tuple[Parameter, ...]:
        """Return the time constant."""
        return (Parameter("tau", "s", 0.0, facts.period, null=0.0),)

    def apply(self, pv: FloatArray, values: FloatArray, ts: float) -> FloatArray:
        """Return the output of the transmitter."""
        return lagged(pv, float(values[0]) / ts)
