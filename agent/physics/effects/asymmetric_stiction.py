"""Friction that differs between a rising and a falling stem."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from agent.physics.effect import Facts, Parameter, Stage
from agent.physics.effects.hysteresis import (
    J_BY_LAW,
    STIFF,
    motion_of,
    motion_values,
    motions,
    moved_stems,
    moving,
    start_of,
)
from agent.units import FrictionBands

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from agent.physics.valves.damped_stem import DampedStem

    FloatArray = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class AsymmetricStiction:
    """Dead band 2 f_D and a slip jump of its own in either direction: S of a direction is their sum.

    Friction by direction has four bands. But raising f_S and f_D in one direction and lowering them as much
    in the other only shifts the position, and no record of PV distinguishes that from another level. Equal
    kinetic friction in both directions is one of these equivalent valves
    (docs/effects/asymmetric_stiction.md).
    """

    name: str = "asymmetric_stiction"
    family: str = "valve_hysteresis"
    stage: Stage = "valve"
    bases: tuple[str, ...] = ()

    def parameters(self, facts: Facts) -> tuple[Parameter, ...]:
        """Return dead band, both slip jumps (all three at 0 remove it), first slip, how the stem moves."""
        return (
            Parameter("dead_band", "OP", 0.0, facts.op_span, null=0.0, by_law=J_BY_LAW),
            Parameter("j_up", "OP", 0.0, facts.op_span, null=0.0, by_law=J_BY_LAW),
            Parameter("j_down", "OP", 0.0, facts.op_span, null=0.0, by_law=J_BY_LAW),
            start_of(facts),
            *motion_of(facts, STIFF),
        )

    def apply(self, position: FloatArray, values: FloatArray, ts: float) -> FloatArray:
        """Return where the stem is."""
        return np.asarray(self.apply_all(position[np.newaxis], values[np.newaxis], ts)[0])

    def apply_all(self, positions: FloatArray, values: FloatArray, ts: float) -> FloatArray:
        """Return where each of many stems is."""
        f_d, up, down = values[:, 0] / 2, values[:, 1], values[:, 2]
        valves = np.array((f_d + up, f_d + down, f_d, values[:, 3]))
        return moved_stems(positions, valves, motions(values[:, 4:], ts))

    def values_of(self, bands: FrictionBands, start: float, stem: DampedStem, ts: float) -> FloatArray:
        """Return the values of a valve with these bands in both directions."""
        return np.array([bands.dead_band, bands.j, bands.j, start, *motion_values(stem, ts)[: len(STIFF)]])

    def valve_of(self, values: FloatArray, ts: float) -> tuple[FrictionBands, float, DampedStem]:
        """Return bands with the mean of both slip jumps, start and stem of the values."""
        dead_band, j_up, j_down, start = (float(value) for value in values[:4])
        jump = (j_up + j_down) / 2
        return FrictionBands.from_s_j(dead_band + jump, jump), start, moving(values[4:], ts)
