"""Losses that bend: a vessel that radiates, or one that runs out through an orifice."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from agent.physics.bases.losing_process import LosingProcess
from agent.physics.effect import Facts, Parameter, Stage

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from agent.physics.bases.linear_process import LinearProcess

    FloatArray = NDArray[np.float64]

STEEPEST = 4.0
"""Largest |curvature x OP's span|. Where OP leads the vessel, as in closed loop, what is held has a far
smaller range; where it waits, the slope of the losses vanishes at 2."""


@dataclass(frozen=True, slots=True)
class LossCurve:
    """What a vessel loses grows faster than what it holds, or slower.

    Gain and time constant change together: both are over the slope of the losses, and meant at ``level``.
    """

    name: str = "loss_curve"
    family: str = "pv_gain"
    stage: Stage = "process"
    bases: tuple[str, ...] = ("fopdt", "sopdt")

    def parameters(self, facts: Facts) -> tuple[Parameter, ...]:
        """Return the curvature of the losses, and the OP at which it is meant, the middle of its range."""
        most, middle = STEEPEST / facts.op_span, 0.5 * (facts.op_low + facts.op_high)
        return (
            Parameter("curvature", "1/OP", -most, most, null=0.0),
            Parameter("level", "OP", middle, middle),
        )

    def change(self, process: LinearProcess, values: FloatArray) -> LinearProcess:
        """Return the process with such losses."""
        curvature, level = (float(each) for each in values)
        if curvature == 0.0:
            return process
        return LosingProcess(
            process.delay,
            process.lags,
            lead=process.lead,
            creep=process.creep,
            curvature=curvature,
            level=level,
        )
