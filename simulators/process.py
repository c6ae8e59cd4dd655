"""Response of PV to the flow through the valve: lags or an integrator behind a dead time."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from agent.jit import kernel
from simulators.parts.first_order import driven, heated

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from simulators.parameters import ProcessParameters

    FloatArray = NDArray[np.float64]


@kernel
def lag(inputs: FloatArray, level: float, keep: float) -> FloatArray:
    """Response of a first-order lag to inputs held over each step, same unit, shape (n,).

    Args:
        inputs: Shape (n,).
        level: Output before the first step.
        keep: exp(-dt / tau).
    """
    outputs = np.empty(inputs.size)
    for i in range(inputs.size):
        level = inputs[i] + (level - inputs[i]) * keep
        outputs[i] = level
    return outputs


class SimulatedProcess:
    """The process of one loop, moving through time, in deviations from its operating point."""

    def __init__(self, parameters: ProcessParameters, dt: float, op: float = 0.0) -> None:
        self._parameters = parameters
        self._dt = dt
        self._drive = op - parameters.no_drive
        self._speed_0 = math.copysign(max(abs(self._drive) - parameters.friction, 0.0), self._drive)
        self._keep = [math.exp(-dt / tau) for tau in parameters.taus]
        self._levels = [0.0] * len(self._keep)
        self._volume = 0.0
        self._speed = 0.0
        self._travelling = np.zeros(round(parameters.delay / dt))

    @property
    def pv(self) -> float:
        """PV now, deviation from its operating point, PV units."""
        has = self._parameters
        level = self._volume if has.kind == "integrating" else self._levels[-1]
        return has.gain * (level - has.lead * self._speed)

    @property
    def level(self) -> float:
        """PV now over its gain, deviation from its operating point, OP units."""
        return self.pv / self._parameters.gain

    def respond(self, flow: FloatArray, load: float) -> None:
        """Take in the valve's flow over the next steps and a load held meanwhile.

        Args:
            flow: Deviation of the valve position from the operating point, OP units, shape (steps,).
            load: Disturbance at the process input behind the dead time, OP units.
        """
        line = np.concatenate((self._travelling, flow))
        through, self._travelling = line[: flow.size] + load, line[flow.size :]
        if self._parameters.absolute or self._parameters.friction:
            self._levels[0] = self._balanced(through)
            return
        for i, keep in enumerate(self._keep):
            before = through[-1]
            through = lag(through, self._levels[i], keep)
            self._levels[i] = float(through[-1])
            self._speed = float(before - through[-1]) / self._parameters.taus[i]
        if self._parameters.kind == "integrating":
            self._volume += float(through.sum()) * self._dt

    def _balanced(self, through: FloatArray) -> float:
        """Return the level after a balance that is not linear."""
        has, step = self._parameters, self._dt / self._parameters.taus[0]
        if has.absolute is not None:
            return float(heated(through, self._levels[0], step, has.absolute)[-1])
        speed = self._levels[0] + self._speed_0
        return float(driven(through + self._drive, speed, step, has.friction)[-1]) - self._speed_0
