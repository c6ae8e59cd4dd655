"""Static friction above kinetic: the stem sticks, then slips."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from agent.physics.effect import Facts, Parameter, Stage
from agent.physics.effects.hysteresis import rest_before, start_of
from agent.physics.valves.damped_stem import DampedStem
from agent.physics.valves.law import StictionLaw
from agent.units import FrictionBands

if TYPE_CHECKING:
    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Stiction:
    """Dead band plus stick band S and slip jump J, by a law of ``agent/physics/valves``."""

    name: str = "stiction"
    family: str = "valve_hysteresis"
    stage: Stage = "valve"
    bases: tuple[str, ...] = ()
    law: StictionLaw = field(default_factory=DampedStem)
    """Between a stem that rests after each slip and one that slides on (docs/methods/stiction_laws.md)."""

    def parameters(self, facts: Facts) -> tuple[Parameter, ...]:
        """Return S, J/S and where the stem first slips."""
        return (
            Parameter("s", "OP", 0.0, facts.op_span, null=0.0),
            Parameter("j_over_s", "1", 0.0, 1.0, natural=True),
            start_of(facts),
        )

    def apply(self, position: FloatArray, values: FloatArray, ts: float) -> FloatArray:  # noqa: ARG002
        """Return where the stem is."""
        s, j_over_s, start = (float(value) for value in values)
        if s == 0.0:
            return position
        bands = FrictionBands.from_s_j(s, j_over_s * s)
        return self.law.position(
            position, bands, rest_before(float(position[0]), bands.f_s, bands.f_s, start)
        )

    def values_of(self, bands: FrictionBands, start: float) -> FloatArray:
        """Return the values of a valve with these bands."""
        return np.array([bands.s, bands.j / bands.s if bands.s > 0.0 else 0.0, start])
