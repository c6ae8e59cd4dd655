"""One lag more in the process."""

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
class SecondOrder:
    """A further time constant, of a vessel, a jacket, a heat exchanger's wall."""

    name: str = "second_order"
    family: str = "extra_lag"
    stage: Stage = "process"
    bases: tuple[str, ...] = ()

    def parameters(self, facts: Facts) -> tuple[Parameter, ...]:
        """Return the time constant."""
        return (Parameter("tau", "s", 0.0, facts.period, null=0.0),)

    def change(self, process: LinearProcess, values: FloatArray) -> LinearProcess:
        """Return the process with the lag."""
        return replace(process, lags=(*process.lags, float(values[0])))
