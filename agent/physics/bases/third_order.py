"""Any linear process of order three, plus dead time: two lags or a resonance, one lag more, two zeros.

Y / U = (1 + z T s + c T^2 s^2) exp(-theta s) / ((1 + 2 zeta T s + T^2 s^2) (1 + lambda s)). An arm that bends
behind its drive, masses on springs that are pushed at one and measured at another, a heated tube.
Source: L. Ljung, System Identification, 2nd ed., 4.2 (output error); D. Seborg et al., Process Dynamics and
Control, 3rd ed., 6.1.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from agent.physics.bases.between_samples import APART, first_values
from agent.physics.bases.held_modes import held_filter
from agent.physics.bases.lag_bases import delay_of, lag_of
from agent.physics.bases.oscillatory import DAMPING, RingingProcess, poles_of
from agent.physics.effect import Facts, Parameter

if TYPE_CHECKING:
    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]

ZERO = (-30.0, 30.0)
"""Of z: where the gain at rest is small beside a resonance, the zeros are far from the poles."""
CURVE = (-30.0, 30.0)
"""Of c, the same over T squared: negative with one zero on each side."""


@dataclass(frozen=True, slots=True)
class ThirdOrderProcess(RingingProcess):
    """The same with whatever lags, lead and creep effects add before it."""

    curve: float = 0.0
    """c."""
    behind: float = 1.0
    """lambda, s."""

    @property
    def settling(self) -> float:
        """Time in which the response has settled, s."""
        return 3 * sum(self.lags) + 3 * self.tau / min(self.damping, 1.0) + 3 * self.behind

    def held(self, ts: float, late: float) -> tuple[FloatArray, FloatArray]:
        """Return numerator and denominator of the filter of a held position, from the sample before on."""
        tau, lag = self.tau / ts, self.behind / ts
        pair = poles_of(tau, self.damping)
        if np.min(np.abs(pair * lag + 1.0)) < APART:
            lag *= 1.0 + APART
        poles = np.append(pair, complex(-1.0 / lag))
        top = 1.0 + self.zero * tau * poles + self.curve * (tau * poles) ** 2
        apart = np.array([np.prod(pole - np.delete(poles, i)) for i, pole in enumerate(poles)])
        residues = np.asarray(top / (tau * tau * lag * apart), dtype=np.complex128)
        return held_filter(poles, residues, late)


@dataclass(frozen=True, slots=True)
class ThirdOrder:
    """Any linear process of order three, plus dead time."""

    name: str = "third_order"
    linear: bool = True

    def parameters(self, facts: Facts) -> tuple[Parameter, ...]:
        """Return delay, time constant, damping, both zeros and the lag."""
        return (
            delay_of(facts),
            lag_of("tau", facts),
            Parameter("damping", "1", *DAMPING, log=True, natural=True),
            Parameter("zero", "1", *ZERO, natural=True),
            Parameter("curve", "1", *CURVE, natural=True),
            lag_of("lag", facts),
        )

    def process(self, values: FloatArray) -> ThirdOrderProcess:
        """Return the process with these values."""
        delay, tau, damping, zero, curve, lag = (float(each) for each in values)
        return ThirdOrderProcess(delay=delay, tau=tau, damping=damping, zero=zero, curve=curve, behind=lag)

    def starts(self, op: FloatArray, pv: FloatArray, facts: Facts) -> FloatArray:
        """Return the values of linear models that are fitted in turns, (m, 6), the best first."""
        return first_values(op, pv, 3, facts.ts)
