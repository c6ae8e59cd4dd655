"""Limits of the stroke: beyond them OP moves and the valve does not."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from agent.physics.effect import Facts, Parameter, Stage

if TYPE_CHECKING:
    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Saturation:
    """A lower and an upper stop, one in each outer quarter of the range of OP.

    Closer together they would make a relay of the valve: what is left of OP's triangle passes for stiction.
    """

    name: str = "saturation"
    family: str = "valve_limits"
    stage: Stage = "valve"
    bases: tuple[str, ...] = ()

    def parameters(self, facts: Facts) -> tuple[Parameter, ...]:
        """Return both stops; at the ends of OP they stop nothing."""
        quarter = facts.op_span / 4
        return (
            Parameter("u_low", "OP", facts.op_low, facts.op_low + quarter, null=facts.op_low),
            Parameter("u_high", "OP", facts.op_high - quarter, facts.op_high, null=facts.op_high),
        )

    def apply(self, position: FloatArray, values: FloatArray, ts: float) -> FloatArray:  # noqa: ARG002
        """Return the position between the stops."""
        return np.clip(position, float(values[0]), float(values[1]))
