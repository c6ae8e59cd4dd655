"""A heated vessel that loses heat by conduction and by radiation; its temperature is PV.

    dT/dt = heat u - loss (T - Ta) - radiation ((T - T0)^4 - (Ta - T0)^4) / (4 (Ta - T0)^3)

Ta: surroundings, T0: absolute zero on the scale of PV. ``radiation`` is counted like ``loss``: what it is for
a vessel as warm as its surroundings. Gain and time constant fall as T rises.
Source: F. Incropera, D. DeWitt, Fundamentals of Heat and Mass Transfer, 6th ed., 5.3 (lumped capacitance).
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from agent.jit import kernel
from agent.physics.bases.lag_bases import delay_of
from agent.physics.bases.late import late
from agent.physics.effect import Facts, Parameter

if TYPE_CHECKING:
    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]

TAUS = (0.1, 0.5, 2.0)
"""Time constants where fits begin, parts of OP's dominant period."""
RADIATED = (0.1, 1.0)
"""Radiation over conduction where fits begin."""
FARTHEST = 20.0
"""The surroundings below the least PV, spans of PV: a furnace that is moved by a twentieth of its warmth."""
BELOW = (0.2, 3.0)
"""The same where fits begin."""
COLDEST = (0.5, 60.0)
"""Absolute zero below the least PV, spans of PV: from a furnace to a room."""
COLDEST_STARTS = (1.0, 5.0)
"""Absolute zero below the surroundings, where fits begin."""


class Heater(NamedTuple):
    """The vessel with all its numbers."""

    delay: float
    """s, as in ``LinearProcess``."""
    heat: float
    """PV units per second and OP unit."""
    loss: float
    """1/s."""
    radiation: float
    """1/s."""
    surroundings: float
    """PV units."""
    absolute_zero: float
    """PV units, below ``surroundings``."""
    start: float
    """PV at the first sample."""

    def respond(self, position: FloatArray, ts: float) -> FloatArray:
        """Return PV, (n,), for heat set at ``position``, (n,), OP units, held from sample to sample."""
        return temperatures(late(position, self.delay, ts), ts, self)


@kernel
def temperatures(power: FloatArray, ts: float, vessel: Heater) -> FloatArray:
    """Return PV at each sample, (n,): in each, the exponential of the balance linearised where it begins."""
    pv = np.empty(power.size)
    cold = max(vessel.surroundings - vessel.absolute_zero, 1e-9)
    warm = vessel.start
    for t in range(power.size):
        pv[t] = warm
        ratio = max((warm - vessel.absolute_zero) / cold, 0.0)
        rate = vessel.loss + vessel.radiation * ratio**3
        lost = vessel.loss * (warm - vessel.surroundings) + 0.25 * vessel.radiation * cold * (ratio**4 - 1.0)
        warm += (vessel.heat * power[t] - lost) * -np.expm1(-rate * ts) / rate
    return pv


@dataclass(frozen=True, slots=True)
class HeaterBase:
    """A heated vessel; the response is PV itself."""

    name: str = "heater"
    linear: bool = False

    def parameters(self, facts: Facts) -> tuple[Parameter, ...]:
        """Return the numbers of ``Heater`` in their order."""
        span = facts.pv_high - facts.pv_low
        slow, fast = 0.1 / facts.duration, 1.0 / facts.ts
        near, far = COLDEST
        return (
            delay_of(facts),
            Parameter(
                "heat", "PV/s/OP", slow * span / facts.op_span, 10 * fast * span / facts.op_span, log=True
            ),
            Parameter("loss", "1/s", 0.01 * slow, fast, log=True),
            Parameter("radiation", "1/s", 0.01 * slow, fast, log=True, natural=True),
            Parameter("surroundings", "PV", facts.pv_low - FARTHEST * span, facts.pv_high, natural=True),
            Parameter(
                "absolute_zero", "PV", facts.pv_low - far * span, facts.pv_low - near * span, natural=True
            ),
            Parameter("start", "PV", facts.pv_low, facts.pv_high, of_record=True, natural=True),
        )

    def process(self, values: FloatArray) -> Heater:
        """Return the vessel."""
        return Heater(*(float(each) for each in values))

    def starts(self, op: FloatArray, pv: FloatArray, facts: Facts) -> FloatArray:
        """Return vessels that balance mean OP at mean PV, (m, 7), quick or slow, radiating much or little."""
        span, low = facts.pv_high - facts.pv_low, facts.pv_low
        warm, power = float(pv.mean()), max(float(op.mean()), 0.1 * facts.op_span)
        found = []
        for tau, radiated, cold, below in product(TAUS, RADIATED, COLDEST_STARTS, BELOW):
            ambient, loss = low - below * span, 1.0 / (tau * facts.period)
            zero = ambient - cold * span
            ratio = (warm - zero) / (ambient - zero)
            loss /= 1.0 + radiated * ratio**3
            lost = loss * (warm - ambient) + radiated * loss * 0.25 * (ambient - zero) * (ratio**4 - 1.0)
            found.append((2 * facts.ts, lost / power, loss, radiated * loss, ambient, zero, float(pv[0])))
        return np.array(found)
