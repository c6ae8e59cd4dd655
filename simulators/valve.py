"""A pneumatic valve: I/P converter, actuator with spring, stem with friction, stops, slack, and its trim."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from agent.jit import kernel
from simulators.friction import Actuator, StemParameters, stroke

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from simulators.parameters import ValveParameters

    FloatArray = NDArray[np.float64]

STEP = {"none": 0.002, "karnopp": 0.002, "lugre": 0.001}
"""Longest step of integration by friction law, s (docs/simulators.md shows what a finer one changes)."""

RESTS = 1e-3
"""Speed over f_S + f_D, 1/s, below which a stem rests: bristles creep for long."""
PLACE = 0.02
"""Way over f_S + f_D after which a stem that rests has other friction, where friction scatters."""


@kernel
def play(positions: FloatArray, plug: float, slack: float) -> FloatArray:
    """Positions (n,) of a plug that stood at ``plug`` and is pushed by a stem at ``positions`` (n,)."""
    moved = np.empty(positions.size)
    for i in range(positions.size):
        plug = min(max(plug, positions[i] - 0.5 * slack), positions[i] + 0.5 * slack)
        moved[i] = plug
    return moved


class SimulatedValve:
    """The valve of one loop, moving through time.

    It starts at rest and as far behind its balance as friction can hold it: so a sticking loop begins to
    cycle without a disturbance.
    """

    def __init__(
        self,
        parameters: ValveParameters,
        op_range: tuple[float, float],
        op: float,
        rng: np.random.Generator | None = None,
    ) -> None:
        low, high = op_range
        span = high - low
        stem = StemParameters(
            f_s=parameters.f_s,
            f_d=parameters.f_d,
            f_s_closing=parameters.f_s * parameters.closing,
            f_d_closing=parameters.f_d * parameters.closing,
            inertia=parameters.inertia,
            damping=parameters.damping,
            stribeck=parameters.stribeck * span,
            still=parameters.still * span,
            bristle_stiffness=parameters.bristle_stiffness,
            bristle_damping=parameters.bristle_damping,
        )
        stops = parameters.stops or op_range
        rate = math.inf if parameters.rate is None else parameters.rate
        self._actuator = Actuator(stem, parameters.law == "lugre", parameters.tau_ip, rate, *stops)
        start = min(max(op - parameters.f_s, stops[0]), stops[1])
        self._state = np.array([op, start, 0.0, 0.0])
        self._plug, self._slack = start, parameters.backlash
        self._low, self._span, self._rangeability = low, span, parameters.rangeability
        self._split = parameters.split
        self._median, self._scatter, self._rng = stem, parameters.scatter, rng or np.random.default_rng(0)
        self._stood = start

    @property
    def position(self) -> float:
        """Stem position now, OP units."""
        return float(self._state[1])

    def flow(self, position: FloatArray) -> FloatArray:
        """What flows through at a position of the plug, in percent of the most as OP is, same shape."""
        if self._split is not None:
            ends, begins, slope = self._split
            position = np.minimum(position, ends) + slope * np.maximum(position - begins, 0.0)
        if self._rangeability == 1.0:
            return position
        opened = (position - self._low) / self._span
        return self._low + self._span * (self._rangeability**opened - 1) / (self._rangeability - 1)

    def stroke(self, op: float, steps: int, dt: float) -> FloatArray:
        """Hold ``op`` for ``steps`` steps of ``dt`` s; the plug's positions, OP units, shape (steps,)."""
        positions = stroke(self._state, op, steps, dt, self._actuator)
        if self._scatter > 0.0:
            self._rests_anew()
        if self._slack > 0.0:
            positions = play(positions, self._plug, self._slack)
            self._plug = float(positions[-1])
        return positions

    def _rests_anew(self) -> None:
        """Draw the friction of a stem that has gone a way and rests, where it scatters."""
        band = self._median.f_s + self._median.f_d
        rests = abs(self._state[2]) < RESTS * band
        if not rests or abs(self._state[1] - self._stood) < PLACE * band:
            return
        self._stood = float(self._state[1])
        factor = math.exp(self._scatter * self._rng.standard_normal())
        self._actuator = self._actuator._replace(
            stem=self._median._replace(
                f_s=factor * self._median.f_s,
                f_d=factor * self._median.f_d,
                f_s_closing=factor * self._median.f_s_closing,
                f_d_closing=factor * self._median.f_d_closing,
            )
        )
