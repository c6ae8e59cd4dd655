"""A load that changes once and stays."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from agent.physics.effect import Facts, Parameter, Stage

if TYPE_CHECKING:
    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]

EDGE = 0.05
"""Share of the record at either end in which a step is not told from the level."""


@dataclass(frozen=True, slots=True)
class LoadStep:
    """A step behind a lag of its own on PV; its height is solved for.

    A load enters through the process, but seldom by the valve's way: the lag is searched, not taken from the
    process. None at all is a step of the level or of the transmitter, one of four periods is a slow load on
    an integrating process.
    """

    name: str = "load_step"
    family: str = "disturbance"
    stage: Stage = "disturbance"
    bases: tuple[str, ...] = ()

    def parameters(self, facts: Facts) -> tuple[Parameter, ...]:
        """Return the instant and the lag."""
        first, last = EDGE * facts.duration, (1 - EDGE) * facts.duration
        return (
            Parameter("time", "s", first, last, of_record=True),
            Parameter("tau", "s", 0.0, 4 * facts.period),
        )

    def columns(self, time: FloatArray, response: FloatArray, values: FloatArray) -> FloatArray:  # noqa: ARG002
        """Return the step of height one, (n, 1)."""
        since = np.maximum(time - float(values[0]), 0.0)
        tau = float(values[1])
        step = -np.expm1(-since / tau) if tau > 0.0 else np.where(since > 0.0, 1.0, 0.0)
        return np.asarray(step[:, np.newaxis])
