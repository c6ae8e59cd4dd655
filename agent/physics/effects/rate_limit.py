"""Actuator whose speed is limited by its air supply."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from agent.jit import kernel
from agent.physics.effect import Facts, Parameter, Stage

if TYPE_CHECKING:
    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]

SLOWEST = 0.1
"""Least rate, over the mean speed of OP: a slower valve would hardly follow."""


@kernel
def slewed(command: FloatArray, step: float) -> FloatArray:
    """Return ``command`` (n,) followed by at most ``step`` a sample, same unit, from its first value."""
    position = np.empty(command.size)
    x = command[0] if command.size else 0.0
    for t in range(command.size):
        x = min(max(command[t], x - step), x + step)
        position[t] = x
    return position


@dataclass(frozen=True, slots=True)
class RateLimit:
    """A fastest speed, the same in both directions."""

    name: str = "rate_limit"
    family: str = "valve_speed"
    stage: Stage = "valve"
    bases: tuple[str, ...] = ()

    def parameters(self, facts: Facts) -> tuple[Parameter, ...]:
        """Return the rate; one that takes the whole span in a sample limits nothing."""
        unlimited = facts.op_span / facts.ts
        slowest = min(SLOWEST * facts.op_speed, 0.5 * unlimited)
        return (Parameter("rate", "OP/s", slowest, unlimited, null=unlimited, log=True),)

    def apply(self, position: FloatArray, values: FloatArray, ts: float) -> FloatArray:
        """Return where the actuator is."""
        return slewed(position, float(values[0]) * ts)
