"""Square of a flow: an orifice whose transmitter does not extract the root."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from agent.physics.effect import Facts, Parameter, Stage
from agent.physics.effects.pv_gain import LEVELLED

if TYPE_CHECKING:
    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]

FARTHEST = 4.0
"""OP of no flow, spans beyond both ends of OP's span: from there the square is nearly a straight line."""
DISTANCES = (0.0, 0.1, 0.3, 0.8, 2.0)
"""Of the OP of no flow from either end, spans, from which a search begins."""


@dataclass(frozen=True, slots=True)
class SquareLaw:
    """Slope from flow to measured value that is proportional to the flow.

    A valve that closes with OP has no flow above OP's span. Source: ISO 5167-2, Measurement of fluid flow by
    means of pressure differential devices: the pressure across an orifice is as the square of the flow.
    """

    name: str = "square_law"
    family: str = "pv_gain"
    stage: Stage = "sensor"
    bases: tuple[str, ...] = LEVELLED

    def parameters(self, facts: Facts) -> tuple[Parameter, ...]:
        """Return the OP at which nothing flows in the long run."""
        beyond = FARTHEST * facts.op_span
        return (Parameter("no_flow", "OP", facts.op_low - beyond, facts.op_high + beyond, natural=True),)

    def spotted(self, residual: FloatArray, facts: Facts) -> FloatArray:  # noqa: ARG002
        """Return places below and above OP's span, (m, 1)."""
        off = facts.op_span * np.array(DISTANCES)
        return np.concatenate((facts.op_low - off, facts.op_high + off))[:, np.newaxis]

    def apply(self, pv: FloatArray, values: FloatArray, ts: float) -> FloatArray:  # noqa: ARG002
        """Return the measured value; at OP 0 it has a slope of one, whichever way it would flow there."""
        no_flow = float(values[0])
        flow = pv - no_flow
        return np.asarray(flow * np.abs(flow) / (2.0 * (abs(no_flow) or 1.0)))
