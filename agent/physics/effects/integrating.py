"""Process that does not come to rest: PV goes on moving after its first response."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from agent.physics.effect import Facts, Parameter, Stage

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from agent.physics.bases.linear_process import LinearProcess

    FloatArray = NDArray[np.float64]

FASTEST = 50.0
"""Creep times period: the integral is then eight times the first response at the frequency of the loop."""


@dataclass(frozen=True, slots=True)
class Integrating:
    """PV adds the integral of its own response: 1 + creep/s behind the lags.

    With creep 1/tau a first-order process becomes an integrator, with a large one an integrator behind a lag.
    """

    name: str = "integrating"
    family: str = "process_dynamics"
    stage: Stage = "process"
    bases: tuple[str, ...] = ("fopdt", "sopdt")

    def parameters(self, facts: Facts) -> tuple[Parameter, ...]:
        """Return the speed at which PV goes on, over its first response."""
        return (Parameter("creep", "1/s", 0.0, FASTEST / facts.period, null=0.0),)

    def change(self, process: LinearProcess, values: FloatArray) -> LinearProcess:
        """Return the process with the integral."""
        return replace(process, creep=float(values[0]))
