"""Sticking valve with a static and a kinetic friction band: He, Wang, Pottmann and Qin (2007).

IECR 46:4549. The published flow chart keeps the force that is still held by friction, u_r. Written with the
stem position x instead (u_r = u - x) it needs no state but x, and gives the same numbers.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from agent.jit import kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from agent.units import FrictionBands


@kernel
def he2007(op: NDArray[np.float64], f_s: float, f_d: float, x0: float) -> NDArray[np.float64]:
    """Return the valve positions, OP units, shape (n,).

    The stem rests until the force on it, OP minus position, exceeds ``f_s``; then it slips until only ``f_d``
    of that force remains. A force of exactly ``f_s`` does not move it. While OP is NaN the position holds.

    Args:
        op: Controller output, OP units, shape (n,).
        f_s: Static friction band, OP units.
        f_d: Kinetic friction band, OP units, 0 <= f_d <= f_s.
        x0: Position before the first sample, OP units; OP(0) itself is the paper's u_r(0) = 0.
    """
    position = np.empty(op.size)
    x = x0
    for t in range(op.size):
        force = op[t] - x
        if force > f_s:
            x = op[t] - f_d
        elif force < -f_s:
            x = op[t] + f_d
        position[t] = x
    return position


@dataclass(frozen=True, slots=True)
class He2007:
    """He's valve."""

    name: str = "he2007"
    reference: str = "He, Wang, Pottmann, Qin, Industrial & Engineering Chemistry Research 46 (2007) 4549"

    def position(self, op: NDArray[np.float64], bands: FrictionBands, x0: float) -> NDArray[np.float64]:
        """Return the valve positions, OP units, shape (n,)."""
        return he2007(op, bands.f_s, bands.f_d, x0)
