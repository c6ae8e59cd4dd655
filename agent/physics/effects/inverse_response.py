"""Process that first goes the wrong way: cold feed water into a boiling drum, a reboiler's swelling sump."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from agent.physics.effect import Facts, Parameter, Stage

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from agent.physics.bases.linear_process import LinearProcess

    FloatArray = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class InverseResponse:
    """A zero in the right half plane: 1 - lead s."""

    name: str = "inverse_response"
    family: str = "process_dynamics"
    stage: Stage = "process"
    bases: tuple[str, ...] = ()

    def parameters(self, facts: Facts) -> tuple[Parameter, ...]:
        """Return the time constant of the zero."""
        return (Parameter("lead", "s", 0.0, facts.period, null=0.0),)

    def change(self, process: LinearProcess, values: FloatArray) -> LinearProcess:
        """Return the process with the zero."""
        return replace(process, lead=float(values[0]))
