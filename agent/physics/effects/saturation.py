"""Limits of the stroke: beyond them OP moves and the valve does not."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from agent.physics.effect import Facts, Parameter, Stage

if TYPE_CHECKING:
    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]

NARROWEST = 0.5
"""Least distance of two stops that both act, over the span of what is commanded."""
STARTS = 12
"""Places of either stop, without the other, from which a search begins."""


@dataclass(frozen=True, slots=True)
class Saturation:
    """A lower and an upper stop.

    One stop may lie anywhere: beyond it OP winds up as far as the controller allows. Two stops that act and
    are close together would turn the valve into a relay, and the rest of OP's triangle would look like
    stiction: such a pair counts as no stops.
    """

    name: str = "saturation"
    family: str = "valve_limits"
    stage: Stage = "valve"
    bases: tuple[str, ...] = ()

    def parameters(self, facts: Facts) -> tuple[Parameter, ...]:
        """Return both stops; at the ends of OP they stop nothing."""
        return (
            Parameter("u_low", "OP", facts.op_low, facts.op_high, null=facts.op_low),
            Parameter("u_high", "OP", facts.op_low, facts.op_high, null=facts.op_high),
        )

    def spotted(self, residual: FloatArray, facts: Facts) -> FloatArray:  # noqa: ARG002
        """Return each stop at some places, the other where it stops nothing, (m, 2)."""
        places = facts.op_low + facts.op_span * np.arange(1, STARTS + 1) / (STARTS + 1)
        lower = np.column_stack((places, np.full(STARTS, facts.op_high)))
        return np.vstack((lower, np.column_stack((np.full(STARTS, facts.op_low), places))))

    def apply(self, position: FloatArray, values: FloatArray, ts: float) -> FloatArray:  # noqa: ARG002
        """Return the position between the stops, or unchanged where they would make the valve a relay."""
        low, high = float(values[0]), float(values[1])
        least, most = float(position.min()), float(position.max())
        if low > least and high < most and high - low < NARROWEST * (most - least):
            return position
        return np.clip(position, low, high)
