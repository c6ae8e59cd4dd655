"""Trim with a nonlinear flow over the stroke: equal-percentage or quick-opening."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from agent.physics.effect import Facts, Parameter, Stage

if TYPE_CHECKING:
    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]

STEEPEST = 4.0
"""Log of the ratio of the slopes at both ends of OP: about the rangeability of 50 of a common trim."""
REACH = 8.0
"""Largest |curvature x OP|: slopes at OP 0 and the farthest OP in a ratio of 3000, more than any trim."""


@dataclass(frozen=True, slots=True)
class Characteristic:
    """Slope that grows (curvature > 0, equal-percentage) or falls (quick-opening) at a constant rate.

    Equal-percentage after IEC 60534-2-4: flow over full flow R^(x - 1), R the rangeability; curvature is
    ln R over the full stroke. Gain and level are solved for, so that only the shape counts; it is counted
    from OP 0, and one curvature means the same in every record of the loop.
    """

    name: str = "characteristic"
    family: str = "valve_characteristic"
    stage: Stage = "valve"
    bases: tuple[str, ...] = ()

    def parameters(self, facts: Facts) -> tuple[Parameter, ...]:
        """Return the curvature."""
        farthest = max(abs(facts.op_low), abs(facts.op_high))
        most = min(STEEPEST / facts.op_span, REACH / farthest)
        return (Parameter("curvature", "1/OP", -most, most, null=0.0),)

    def apply(self, position: FloatArray, values: FloatArray, ts: float) -> FloatArray:  # noqa: ARG002
        """Return the flow, in OP units of a trim that has its slope at OP 0 everywhere."""
        curvature = float(values[0])
        if curvature == 0.0:
            return position
        return np.expm1(curvature * position) / curvature
