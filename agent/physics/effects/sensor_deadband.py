"""Sensor that follows only at the edges of a band: a float that rubs, a linkage with slack."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from agent.physics.effect import Facts, Parameter, Stage
from agent.physics.effects.deadband import backlash
from agent.physics.effects.pv_gain import LEVELLED

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]


BAND_BY_LAW = 0.4
"""``Parameter.by_law`` of the band. Loads move PV within it as well, and no model of OP knows how: nine in
ten of 32 bands of ``simulators.draws.hidden_effects``, seeds 95210 to 95249, are within it."""
BALANCES = ("two_tanks", "heater", "heat_exchanger", "neutralisation")
"""Bases that respond in PV itself."""


@dataclass(frozen=True, slots=True)
class SensorDeadband:
    """A band between PV and its measured value, in the unit in which the base responds.

    That is OP's for a linear base, whose gain is solved for, and PV's for a balance.

    A band of the valve lies before the lags of the process and turns with OP, this one turns with PV.
    """

    name: str = "sensor_deadband"
    family: str = "sensor_hysteresis"
    stage: Stage = "sensor"
    bases: tuple[str, ...] = (*LEVELLED, *BALANCES)

    def parameters(self, facts: Facts) -> tuple[Parameter, ...]:
        """Return the width of the band, and where in it PV is at first: -1 and 1 are its edges."""
        return (
            Parameter("band", facts.response, 0.0, facts.response_span, null=0.0, by_law=BAND_BY_LAW),
            Parameter("start", "1", -1.0, 1.0, of_record=True, natural=True),
        )

    def apply(self, pv: FloatArray, values: FloatArray, ts: float) -> FloatArray:  # noqa: ARG002
        """Return the measured value."""
        band, start = (float(value) for value in values)
        return pv if band == 0.0 else backlash(pv, band, float(pv[0]) + 0.5 * band * start)
