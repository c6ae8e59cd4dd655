"""Backlash between actuator and plug: the valve follows only at the edges of a band."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from agent.jit import kernel
from agent.physics.effect import Facts, Parameter, Stage

if TYPE_CHECKING:
    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]


@kernel
def backlash(command: FloatArray, width: float, start: float) -> FloatArray:
    """Return the position (n,) of a plug that is pushed by the edges of a band ``width`` wide, OP units.

    ``start`` is where it stands before the first sample within the band, -1 to 1.
    """
    position = np.empty(command.size)
    x = command[0] + 0.5 * width * start
    for t in range(command.size):
        x = min(max(x, command[t] - 0.5 * width), command[t] + 0.5 * width)
        position[t] = x
    return position


@dataclass(frozen=True, slots=True)
class Deadband:
    """Slack: a dead band without a slip jump."""

    name: str = "deadband"
    family: str = "valve_hysteresis"
    stage: Stage = "valve"
    bases: tuple[str, ...] = ()

    def parameters(self, facts: Facts) -> tuple[Parameter, ...]:
        """Return the width of the band and where the plug stands in it at first."""
        return (
            Parameter("s", "OP", 0.0, facts.op_span, null=0.0),
            Parameter("start", "1", -1.0, 1.0, of_record=True),
        )

    def apply(self, position: FloatArray, values: FloatArray, ts: float) -> FloatArray:  # noqa: ARG002
        """Return where the plug is."""
        return backlash(position, float(values[0]), float(values[1]))
