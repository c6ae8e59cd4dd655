"""Sticking valve with a dead band, a stick band and a slip jump: Kano, Maruta, Kugemoto and Shimizu (2004).

DYCOPS 2004. The published flow chart keeps the OP at which the stem stopped, u_s, and the direction d of its
last stroke, and compares d (u - u_s) with J and -d (u - u_s) with S. A resting stem stands f_D behind u_s,
so both comparisons require the same force, f_S = (S + J) / 2. Written with that force the model needs no
u_s, and a wrong d or u_s at the start cannot move the stem. The limits of the stroke, which the paper puts
on OP, are left out.
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
def kano2004(
    op: NDArray[np.float64], s_up: float, j_up: float, s_down: float, j_down: float, x0: float
) -> NDArray[np.float64]:
    """Return the valve positions, OP units, shape (n,).

    A resting stem breaks away when the force on it exceeds the static friction of that direction. From then
    on it follows OP at the distance of kinetic friction as long as OP goes on in its direction; it rests
    when OP stops or turns. While OP is NaN the position holds and the stem comes to rest.

    Args:
        op: Controller output, OP units, shape (n,).
        s_up: Dead band plus stick band S of friction against a rising stem, OP units.
        j_up: Slip jump J of a rising stem, OP units, 0 <= j_up <= s_up.
        s_down: S of friction against a falling stem, OP units.
        j_down: J of a falling stem, OP units, 0 <= j_down <= s_down.
        x0: Position of the resting stem before the first sample, OP units.
    """
    f_s_up, f_d_up = (s_up + j_up) / 2, (s_up - j_up) / 2
    f_s_down, f_d_down = (s_down + j_down) / 2, (s_down - j_down) / 2
    position = np.empty(op.size)
    x = x0
    moving = 0.0  # direction of motion, 0 at rest
    former = op[0]
    for t in range(op.size):
        if not (op[t] - former) * moving > 0.0:
            moving = 0.0
            if op[t] - x > f_s_up:
                moving = 1.0
            elif x - op[t] > f_s_down:
                moving = -1.0
        if moving > 0.0:
            x = op[t] - f_d_up
        elif moving < 0.0:
            x = op[t] + f_d_down
        former = op[t]
        position[t] = x
    return position


@dataclass(frozen=True, slots=True)
class Kano2004:
    """Kano's valve, with the same friction in both directions."""

    name: str = "kano2004"
    reference: str = "Kano, Maruta, Kugemoto, Shimizu, DYCOPS 2004"

    def position(self, op: NDArray[np.float64], bands: FrictionBands, x0: float) -> NDArray[np.float64]:
        """Return the valve positions, OP units, shape (n,)."""
        return kano2004(op, bands.s, bands.j, bands.s, bands.j, x0)
