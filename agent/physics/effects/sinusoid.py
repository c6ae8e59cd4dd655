"""A load that swings at one frequency, whatever the loop does."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from agent.physics.effect import Facts, Parameter, Stage

if TYPE_CHECKING:
    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Sinusoid:
    """A wave of constant frequency, amplitude and phase on PV; the latter two are solved for."""

    name: str = "sinusoid"
    family: str = "disturbance"
    stage: Stage = "disturbance"
    bases: tuple[str, ...] = ()

    def parameters(self, facts: Facts) -> tuple[Parameter, ...]:
        """Return the frequency: from three cycles in the record to five samples a cycle."""
        return (Parameter("frequency", "1/s", 3 / facts.duration, 0.2 / facts.ts),)

    def columns(self, time: FloatArray, response: FloatArray, values: FloatArray) -> FloatArray:  # noqa: ARG002
        """Return cosine and sine, (n, 2)."""
        angle = 2 * np.pi * float(values[0]) * time
        return np.column_stack((np.cos(angle), np.sin(angle)))
