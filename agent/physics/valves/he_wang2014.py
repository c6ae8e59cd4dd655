"""Sticking valve whose stem overshoots: the semi-physical model of He and Wang (2010, 2014).

American Control Conference 2010; IECR 53 (2014). The stem is an underdamped mass on a spring: one that breaks
away swings past its balance by nearly as much as it was behind, and static friction catches it there.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from agent.jit import kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from agent.units import FrictionBands

OVERSHOOT = 1.99
"""K of the paper, without unit."""


@kernel
def he_wang2014(
    op: NDArray[np.float64], f_s: float, f_d: float, x0: float, K: float = OVERSHOOT
) -> NDArray[np.float64]:
    """Return the valve positions, OP units, shape (n,).

    The stem rests until the force on it exceeds ``f_s``; then it moves ``K`` times the distance to the
    balance, where ``f_d`` of that force would remain. The slip jump is K (f_S - f_D). While OP is NaN the
    position holds.

    Args:
        op: Controller output, OP units, shape (n,).
        f_s: Static friction band, OP units.
        f_d: Kinetic friction band, OP units, 0 <= f_d <= f_s.
        x0: Position before the first sample, OP units.
        K: Overshoot, 1 to 2, without unit; 1 is He's model of 2007.
    """
    position = np.empty(op.size)
    x = x0
    for t in range(op.size):
        force = op[t] - x
        if force > f_s:
            x += K * (force - f_d)
        elif force < -f_s:
            x += K * (force + f_d)
        position[t] = x
    return position


@dataclass(frozen=True, slots=True)
class HeWang2014:
    """The valve of He and Wang."""

    name: str = "he_wang2014"
    reference: str = "He, Wang, ACC 2010; Industrial & Engineering Chemistry Research 2014"
    K: float = OVERSHOOT
    """Overshoot, 1 to 2, without unit."""

    def position(self, op: NDArray[np.float64], bands: FrictionBands, x0: float) -> NDArray[np.float64]:
        """Return the valve positions, OP units, shape (n,)."""
        return he_wang2014(op, bands.f_s, bands.f_d, x0, self.K)
