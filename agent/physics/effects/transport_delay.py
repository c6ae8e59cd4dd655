"""Dead time that depends on the flow: what the valve lets through travels along a pipe of a given volume."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from agent.physics.bases.lag_bases import delay_of
from agent.physics.effect import Facts, Parameter, Stage

if TYPE_CHECKING:
    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]

FARTHEST, NEAREST = 2.0, 0.05
"""OP at which nothing flows, below the least OP, spans: from a dead time that hardly changes to one that
changes twentyfold."""
SLOWEST = 1e-3
"""Part of the fastest flow that flows at least, so that the pipe empties."""


@dataclass(frozen=True, slots=True)
class TransportDelay:
    """Plug flow: what enters leaves when the volume of the pipe has flowed in behind it.

    The dead time of the base remains as the part that does not depend on the flow.
    Source: K. Zenger, A. Niemi, Modelling and control of a class of time-varying continuous flow processes,
    J. Process Control 19 (2009) 1511.
    """

    name: str = "transport_delay"
    family: str = "process_delay"
    stage: Stage = "valve"
    bases: tuple[str, ...] = ()

    def parameters(self, facts: Facts) -> tuple[Parameter, ...]:
        """Return the volume, in what one OP unit lets through in a second, and the OP of no flow."""
        return (
            Parameter("volume", "OP*s", 0.0, delay_of(facts).high * facts.op_span, null=0.0),
            Parameter(
                "no_flow",
                "OP",
                facts.op_low - FARTHEST * facts.op_span,
                facts.op_low - NEAREST * facts.op_span,
                natural=True,
            ),
        )

    def apply(self, position: FloatArray, values: FloatArray, ts: float) -> FloatArray:
        """Return what leaves the pipe; at the first sample it is full of what enters then."""
        volume, no_flow = (float(value) for value in values)
        flow = position - no_flow
        fastest = float(flow.max())
        if volume == 0.0 or fastest <= 0.0:
            return position
        passed = np.cumsum(np.maximum(flow, SLOWEST * fastest)) * ts
        return np.asarray(np.interp(passed - volume, passed, position), dtype=np.float64)
