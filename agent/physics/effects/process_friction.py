"""Coulomb friction on the moving part of a process: a drive, a carriage, a flap."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from agent.physics.bases.linear_process import LinearProcess
from agent.physics.bases.sliding_process import SlidingProcess
from agent.physics.effect import Facts, Parameter, Stage

if TYPE_CHECKING:
    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]

MOST = 0.5
"""Greatest friction, over OP's span: OP's whole swing would hardly move more."""


@dataclass(frozen=True, slots=True)
class ProcessFriction:
    """Friction that opposes every motion; the viscous part is in the lag and the gain of the base.

    Only for what is driven to a place: on a base of one lag it is a curve with a flat part that may lie
    anywhere in OP's range, and stood for curves that it is not.
    """

    name: str = "process_friction"
    family: str = "process_friction"
    stage: Stage = "process"
    bases: tuple[str, ...] = ("lags_integrator",)

    def parameters(self, facts: Facts) -> tuple[Parameter, ...]:
        """Return the friction, and the OP that drives nothing."""
        return (
            Parameter("friction", "OP", 0.0, MOST * facts.op_span, null=0.0),
            Parameter("no_drive", "OP", facts.op_low, facts.op_high),
        )

    def change(self, process: LinearProcess, values: FloatArray) -> LinearProcess:
        """Return the process with friction."""
        friction, no_drive = (float(each) for each in values)
        if friction == 0.0:
            return process
        return SlidingProcess(
            process.delay, process.lags, process.integrates, friction=friction, no_drive=no_drive
        )
