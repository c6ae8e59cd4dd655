"""A pneumatic valve: I/P converter, actuator with spring, stem with friction, stops at both ends."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from simulators.friction import Actuator, Stem, stroke

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from simulators.parameters import ValveParameters

    FloatArray = NDArray[np.float64]

STEP = {"none": 0.002, "karnopp": 0.002, "lugre": 0.001}
"""Longest step of integration by friction law, s (docs/simulators.md shows what a finer one changes)."""


class Valve:
    """The valve of one loop, moving through time.

    It starts at rest and as far behind its balance as friction can hold it: a sticking loop then begins
    to cycle without waiting for a disturbance.
    """

    def __init__(self, parameters: ValveParameters, op_range: tuple[float, float], op: float) -> None:
        low, high = op_range
        span = high - low
        stem = Stem(
            f_s=parameters.f_s,
            f_d=parameters.f_d,
            inertia=parameters.inertia,
            damping=parameters.damping,
            stribeck=parameters.stribeck * span,
            still=parameters.still * span,
            bristle_stiffness=parameters.bristle_stiffness,
            bristle_damping=parameters.bristle_damping,
        )
        self._actuator = Actuator(stem, parameters.law == "lugre", parameters.tau_ip, low, high)
        self._state = np.array([op, max(op - parameters.f_s, low), 0.0, 0.0])

    @property
    def position(self) -> float:
        """Stem position now, OP units."""
        return float(self._state[1])

    def stroke(self, op: float, steps: int, dt: float) -> FloatArray:
        """Hold ``op`` for ``steps`` steps of ``dt`` s; the positions on the way, OP units, shape (steps,)."""
        return stroke(self._state, op, steps, dt, self._actuator)
