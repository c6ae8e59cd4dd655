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
MOST_BENT = 100.0
"""Curvature times signal at most: a response that integrates goes far beyond OP, and its square is finite."""


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
        return (curvature_of(facts),)

    def apply(self, position: FloatArray, values: FloatArray, ts: float) -> FloatArray:  # noqa: ARG002
        """Return the flow, in OP units of a trim that has its slope at OP 0 everywhere."""
        return bent(position, float(values[0]))


def curvature_of(facts: Facts) -> Parameter:
    """Return the curvature of a curve over OP."""
    farthest = max(abs(facts.op_low), abs(facts.op_high))
    most = min(STEEPEST / facts.op_span, REACH / farthest)
    return Parameter("curvature", "1/OP", -most, most, null=0.0)


def bent(signal: FloatArray, curvature: float) -> FloatArray:
    """Return a signal (n,), OP units, behind a curve whose slope, one at OP 0, grows at a constant rate."""
    if curvature == 0.0:
        return signal
    return np.asarray(np.expm1(np.minimum(curvature * signal, MOST_BENT)) / curvature)
