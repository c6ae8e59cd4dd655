"""Static friction above kinetic: the stem sticks, then slips."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from agent.physics.effect import Facts, Parameter, Stage
from agent.physics.effects.hysteresis import (
    J_BY_LAW,
    S_BY_LAW,
    motion_of,
    motion_values,
    motions,
    moved_stems,
    moving,
    rest_before,
    start_of,
)
from agent.physics.rows import row_of
from agent.physics.valves.damped_stem import DampedStem
from agent.units import FrictionBands

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from agent.physics.valves.law import StictionLaw

    FloatArray = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Stiction:
    """Dead band plus stick band S and slip jump J."""

    name: str = "stiction"
    family: str = "valve_hysteresis"
    stage: Stage = "valve"
    bases: tuple[str, ...] = ()
    law: StictionLaw | None = None
    """Of ``agent/physics/valves``; None: the damped stem, which is between a stem that rests after each slip
    and one that slides on (docs/methods/damped_stem.md), with constants that are searched too."""

    def parameters(self, facts: Facts) -> tuple[Parameter, ...]:
        """Return S, J/S, where the stem first slips, and how it moves."""
        return (
            Parameter("s", "OP", 0.0, facts.op_span, null=0.0, by_law=S_BY_LAW),
            Parameter("j_over_s", "1", 0.0, 1.0, natural=True, by_law=J_BY_LAW),
            start_of(facts),
            *(motion_of(facts) if self.law is None else ()),
        )

    def apply(self, position: FloatArray, values: FloatArray, ts: float) -> FloatArray:
        """Return where the stem is."""
        if self.law is None:
            return np.asarray(self.apply_all(position[np.newaxis], values[np.newaxis], ts)[0])
        s, j_over_s, start = (float(value) for value in values[:3])
        if s == 0.0:
            return position
        bands = FrictionBands.from_s_j(s, j_over_s * s)
        rest = rest_before(float(position[0]), bands.f_s, bands.f_s, start)
        return self.law.position(position, bands, rest)

    def apply_all(self, positions: FloatArray, values: FloatArray, ts: float) -> FloatArray:
        """Return where each of many stems is."""
        if self.law is not None:
            return np.array([self.apply(row_of(positions, i), own, ts) for i, own in enumerate(values)])
        s, jump = values[:, 0], values[:, 1] * values[:, 0]
        f_s, f_d = (s + jump) / 2, (s - jump) / 2
        valves = np.array((f_s, f_s, f_d, values[:, 2]))
        return moved_stems(positions, valves, motions(values[:, 3:], ts))

    def values_of(self, bands: FrictionBands, start: float, stem: DampedStem, ts: float) -> FloatArray:
        """Return the values of a valve with these bands."""
        valve = [bands.s, bands.j / bands.s if bands.s > 0.0 else 0.0, start]
        return np.array([*valve, *(motion_values(stem, ts) if self.law is None else ())])

    def valve_of(self, values: FloatArray, ts: float) -> tuple[FrictionBands, float, DampedStem]:
        """Return bands, start and stem of the values."""
        s, j_over_s, start = (float(value) for value in values[:3])
        stem = moving(values[3:], ts) if self.law is None else DampedStem()
        return FrictionBands.from_s_j(s, j_over_s * s), start, stem
