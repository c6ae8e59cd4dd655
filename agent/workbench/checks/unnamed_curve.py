"""The nearest rival of a curve that nobody named: a curve of any shape, at the valve or at the sensor.

A true cause need not be in the library, and a curve of another shape, or at another place, goes along with
it: a stop where the gain falls with PV, a curvature of the valve where that of a titration is. The rival
bends where it likes. It holds all curves of the library but for their exact shape, so that it need not be
less likely than they: it speaks where the record is very much likelier with it, each number paid by
Schwarz's criterion.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from agent.physics.effect import Facts, Parameter, Stage
from agent.workbench.checks.in_its_place import InItsPlace
from agent.workbench.residual.very_strong import VERY_STRONG

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from agent.physics.bases import Base

    FloatArray = NDArray[np.float64]

CURVES = frozenset({"valve_characteristic", "valve_limits", "pv_gain"})
"""Families whose effects are curves without memory."""
BETTER = "a curve that has no name here makes the record far likelier"
PIECES = 5
"""Straight pieces between the least and the greatest value, as wide each."""
MOST = 3.0
"""Logarithm of a slope over that of the middle piece, at most: a stop, or a valve that opens at once."""


@dataclass(frozen=True, slots=True)
class Curve:
    """A curve that rises everywhere; a rival only, no effect that is named."""

    name: str
    stage: Stage
    family: str = "curve"
    bases: tuple[str, ...] = ()

    def parameters(self, facts: Facts) -> tuple[Parameter, ...]:  # noqa: ARG002
        """Return the logarithm of the slope of each piece over that of the middle one."""
        return tuple(
            Parameter(f"slope_{piece}", "1", -MOST, MOST, null=0.0)
            for piece in range(PIECES)
            if piece != PIECES // 2
        )

    def apply(self, values_in: FloatArray, values: FloatArray, ts: float) -> FloatArray:  # noqa: ARG002
        """Return the curve of what is given, (n,)."""
        low, high = float(values_in.min()), float(values_in.max())
        slopes = np.exp(np.insert(values, PIECES // 2, 0.0))
        width = (high - low) / PIECES
        levels = np.concatenate(([0.0], np.cumsum(slopes * width)))
        return np.interp(values_in, np.linspace(low, high, PIECES + 1), low + levels)


AT_VALVE, AT_SENSOR = Curve("curve_of_valve", "valve"), Curve("curve_of_sensor", "sensor")


def curves_beside(family: str | None, base: Base) -> tuple[InItsPlace, ...]:
    """Return the rivals of an effect of a family on a base."""
    if family not in CURVES or not base.linear:
        return ()
    return tuple(InItsPlace(each, BETTER, -VERY_STRONG) for each in (AT_VALVE, AT_SENSOR))
