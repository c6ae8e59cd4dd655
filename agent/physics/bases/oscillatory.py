"""A process that rings: an underdamped second order with a zero, plus dead time.

Y / U = (1 + z T s) exp(-theta s) / (1 + 2 zeta T s + T^2 s^2). A mass on a spring, a drive with a shaft that
gives, two vessels that exchange, an inner loop that is tuned tightly.
Source: D. Seborg, T. Edgar, D. Mellichamp, F. Doyle, Process Dynamics and Control, 3rd ed., 5.4 and 6.1.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.signal import lfilter

from agent.physics.bases.between_samples import first_values
from agent.physics.bases.held_modes import held_filter
from agent.physics.bases.lag_bases import delay_of, lag_of
from agent.physics.bases.linear_process import LinearProcess, lagged
from agent.physics.effect import Facts, Parameter

if TYPE_CHECKING:
    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]
    ComplexArray = NDArray[np.complex128]

DAMPING = (0.002, 1.5)
"""From hardly damped to two lags; with more damping the two are far apart, and ``sopdt`` is the base."""
ZERO = (-3.0, 6.0)
"""Of the zero's time constant over T: a first move the wrong way, up to one far beyond the end."""

DOUBLE = 1e-4
"""Distance of the damping from one below which both poles would be the same."""


@dataclass(frozen=True, slots=True)
class RingingProcess(LinearProcess):
    """The same with whatever lags, lead and creep effects add before it."""

    tau: float = 1.0
    """T, one over the natural frequency, s per radian."""
    damping: float = 1.0
    """zeta."""
    zero: float = 0.0
    """z."""

    @property
    def settling(self) -> float:
        """Time in which the response has settled, s."""
        return 3 * sum(self.lags) + 3 * self.tau / min(self.damping, 1.0)

    def respond(self, position: FloatArray, ts: float) -> FloatArray:
        """Return the deviation of PV for gain one, OP units, (n,), from rest at the first position.

        Exact for a position that is held between samples; lags use straight lines from sample to sample.
        """
        late = max(self.delay / ts, 1.0) - 1.0
        whole = int(late)
        top, bottom = self.held(ts, late - whole)
        moved = np.zeros_like(position)
        moved[whole + 1 :] = (position - position[0])[: max(len(position) - whole - 1, 0)]
        response = position[0] + lfilter(top, bottom, moved)
        for lag in self.lags:
            response = lagged(response, lag / ts)
        if self.lead > 0.0:
            response = response - self.lead / ts * np.gradient(response)
        if self.creep > 0.0:
            response = response + self.creep * ts * np.cumsum(response - response.mean())
        return np.asarray(response, dtype=np.float64)

    def held(self, ts: float, late: float) -> tuple[FloatArray, FloatArray]:
        """Return numerator and denominator of the filter of a held position, from the sample before on.

        ``late``: part of a sample by which it comes late.
        """
        return second_order(self.tau / ts, self.damping, self.zero, late)

    def counted_from(self, position: FloatArray) -> float:  # noqa: ARG002
        """Return 0: the response has the level of OP."""
        return 0.0


@dataclass(frozen=True, slots=True)
class Oscillatory:
    """Underdamped second order with a zero, plus dead time."""

    name: str = "oscillatory"
    linear: bool = True

    def parameters(self, facts: Facts) -> tuple[Parameter, ...]:
        """Return delay, time constant, damping and zero."""
        return (
            delay_of(facts),
            lag_of("tau", facts),
            Parameter("damping", "1", *DAMPING, log=True, natural=True),
            Parameter("zero", "1", *ZERO, natural=True),
        )

    def process(self, values: FloatArray) -> RingingProcess:
        """Return the process with these values."""
        delay, tau, damping, zero = (float(each) for each in values)
        return RingingProcess(delay=delay, tau=tau, damping=damping, zero=zero)

    def starts(self, op: FloatArray, pv: FloatArray, facts: Facts) -> FloatArray:
        """Return the values of linear models that are fitted in turns, (m, 4), the best first."""
        return first_values(op, pv, 2, facts.ts)


def poles_of(tau: float, damping: float) -> ComplexArray:
    """Return both poles, one over a sample, (2,), never the same; ``tau`` in samples."""
    away = damping if abs(damping - 1.0) > DOUBLE else 1.0 + DOUBLE
    root = np.sqrt(complex(away * away - 1.0))
    return np.asarray((-away + np.array([root, -root])) / tau, dtype=np.complex128)


def second_order(tau: float, damping: float, zero: float, late: float = 0.0) -> tuple[FloatArray, FloatArray]:
    """Return numerator and denominator of the filter of a held input, from the sample before on.

    Args:
        tau: Samples.
        damping: Of the poles.
        zero: Its time constant over ``tau``.
        late: Part of a sample by which the input comes late, for which the one before it still counts.
    """
    poles = poles_of(tau, damping)
    return held_filter(poles, (1.0 + zero * tau * poles) / (tau * tau * (poles - poles[::-1])), late)
