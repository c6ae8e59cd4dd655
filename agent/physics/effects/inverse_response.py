"""Process that first goes the wrong way: cold feed water into a boiling drum, a reboiler's swelling sump."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from agent.physics.effect import Facts, Parameter, Stage

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from agent.physics.bases.linear_process import LinearProcess

    FloatArray = NDArray[np.float64]

MOST_LEAD = 1 / (4 * math.pi)
"""Part of the period, so that the zero lies at twice the frequency of the loop, which no feedback exceeds
(Skogestad and Postlethwaite, Multivariable Feedback Control, 2005, 5.7). With a slower zero the model would
be the inverted controller: minus the rate of OP, which is PV of any loop under integral action."""


@dataclass(frozen=True, slots=True)
class InverseResponse:
    """A zero in the right half plane: 1 - lead s."""

    name: str = "inverse_response"
    family: str = "process_dynamics"
    stage: Stage = "process"
    bases: tuple[str, ...] = ()

    def parameters(self, facts: Facts) -> tuple[Parameter, ...]:
        """Return the time constant of the zero: up to ``MOST_LEAD``, as a lag where no feedback limits it."""
        longest = facts.period * (1.0 if facts.stepped else MOST_LEAD)
        return (Parameter("lead", "s", 0.0, longest, null=0.0),)

    def change(self, process: LinearProcess, values: FloatArray) -> LinearProcess:
        """Return the process with the zero."""
        return replace(process, lead=float(values[0]))
