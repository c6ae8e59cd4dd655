"""Sticking valve that slides on once it has broken away: the two-state residual model.

He's residual force (``he2007``) plus whether the stem moves; on a triangle and a noisy sine it gives what
Kano's and Choudhury's models give. Reference ``methods.md`` 1.5 (derived there; the family of Chen, Tan and
Huang 2008).
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
def two_state(op: NDArray[np.float64], f_s: float, f_d: float, x0: float) -> NDArray[np.float64]:
    """Return the valve positions, OP units, shape (n,).

    A resting stem breaks away when the force on it exceeds ``f_s``. From then on it follows OP at the
    distance ``f_d`` as long as OP goes on in its direction; it rests when OP stops or turns. While OP is NaN
    the position holds and the stem comes to rest.

    Args:
        op: Controller output, OP units, shape (n,).
        f_s: Static friction band, OP units.
        f_d: Kinetic friction band, OP units, 0 <= f_d <= f_s.
        x0: Position of the resting stem before the first sample, OP units.
    """
    position = np.empty(op.size)
    x = x0
    moving = 0.0  # direction of motion, 0 at rest
    former = op[0]
    for t in range(op.size):
        if not (op[t] - former) * moving > 0.0:
            moving = 0.0
            force = op[t] - x
            if force > f_s:
                moving = 1.0
            elif force < -f_s:
                moving = -1.0
        if moving != 0.0:
            x = op[t] - moving * f_d
        former = op[t]
        position[t] = x
    return position


@dataclass(frozen=True, slots=True)
class TwoState:
    """The two-state valve."""

    name: str = "two_state"
    reference: str = "after Chen, Tan, Huang, Industrial & Engineering Chemistry Research 47 (2008) 2842"

    def position(self, op: NDArray[np.float64], bands: FrictionBands, x0: float) -> NDArray[np.float64]:
        """Return the valve positions, OP units, shape (n,)."""
        return two_state(op, bands.f_s, bands.f_d, x0)
