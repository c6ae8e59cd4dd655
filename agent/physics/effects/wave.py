"""A load that repeats itself and is no sinusoid: pulses, a relay, a reciprocating machine."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from agent.physics.effect import Facts, Parameter, Solved
from agent.physics.effects.sinusoid import FASTEST, Sinusoid, wave_columns

if TYPE_CHECKING:
    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]

HARMONICS = 3
"""Multiples of the frequency that a search has, itself included: behind the lag of most processes higher ones
are in the noise."""


@dataclass(frozen=True, slots=True)
class RepeatingWave(Sinusoid):
    """A wave of constant frequency with its harmonics on PV; amplitudes are solved for."""

    name: str = "wave"
    harmonics: int = HARMONICS
    """Multiples of the frequency that it has, itself included."""

    def parameters(self, facts: Facts) -> tuple[Parameter, ...]:
        """Return the frequency: from three cycles in the record to five samples a cycle of a harmonic.

        Where an edge lies within a sample is not known, so neither is the length of the record in cycles.
        """
        highest = max(FASTEST / facts.ts / self.harmonics, 4 / facts.duration)
        a_sample = facts.ts / facts.duration
        return (Parameter("frequency", "1/s", 3 / facts.duration, highest, by_law=a_sample),)

    def columns(self, time: FloatArray, response: FloatArray, values: FloatArray) -> FloatArray:  # noqa: ARG002
        """Return cosine and sine of each harmonic, (n, 2 ``harmonics``)."""
        return wave_columns(time, float(values[0]), self.harmonics)

    def solved(self, coefficients: FloatArray, gain: float) -> dict[str, Solved]:
        """Return amplitude and phase of each harmonic, as of a sinusoid."""
        found = {}
        for at in range(self.harmonics):
            own = Sinusoid.solved(self, coefficients[2 * at : 2 * at + 2], gain)
            found.update({f"{name}_{at + 1}" if at else name: each for name, each in own.items()})
        return found
