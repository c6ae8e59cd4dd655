"""Process whose gain is another from an instant on: fouling, a by-pass opened, another product."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from agent.physics.effect import Facts, Parameter, Stage

if TYPE_CHECKING:
    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]

EDGE = 0.1
"""Share of the record at either end that is too short to show another gain."""


@dataclass(frozen=True, slots=True)
class GainChange:
    """More or less of the response from an instant on; how much is solved for.

    Counted from the mean response before: at the operating point of that time the change makes no
    difference. A change of level that comes with it is a ``load_step``.
    """

    name: str = "gain_change"
    family: str = "gain"
    stage: Stage = "disturbance"
    bases: tuple[str, ...] = ()

    def parameters(self, facts: Facts) -> tuple[Parameter, ...]:
        """Return the instant."""
        first, last = EDGE * facts.duration, (1 - EDGE) * facts.duration
        return (Parameter("time", "s", first, last, of_record=True),)

    def columns(self, time: FloatArray, response: FloatArray, values: FloatArray) -> FloatArray:
        """Return the response after the instant, zero before, (n, 1)."""
        after = time > float(values[0])
        changed = np.where(after, response - response[~after].mean(), 0.0)
        return np.asarray(changed[:, np.newaxis])
