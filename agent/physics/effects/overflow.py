"""Tanks that overflow: no level exceeds its limit; part of the upper tank's spill falls into the lower."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from agent.physics.effect import Facts, Parameter, Stage

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from agent.physics.bases.two_tanks import TwoTanks

    FloatArray = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Overflow:
    """Limits of both tanks, and the spill from the upper into the lower."""

    name: str = "overflow"
    family: str = "process_limits"
    stage: Stage = "process"
    bases: tuple[str, ...] = ("two_tanks",)

    def parameters(self, facts: Facts) -> tuple[Parameter, ...]:
        """Return limit of the upper tank, share of its spill, and PV at which the lower is full."""
        span = facts.pv_high - facts.pv_low
        return (
            Parameter("limit_1", "PV", 0.2 * span, 20 * span, log=True),
            Parameter("share", "1", 0.0, 1.0, natural=True),
            Parameter("limit_2", "PV", facts.pv_high - 0.5 * span, facts.pv_high + 0.05 * span),
        )

    def change(self, process: TwoTanks, values: FloatArray) -> TwoTanks:
        """Return the tanks with their limits."""
        upper, share, lower = (float(each) for each in values)
        return process._replace(limit_1=upper, share=share, limit_2=lower)
