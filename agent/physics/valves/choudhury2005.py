"""Sticking valve with dead band, stick band and slip jump: Choudhury, Thornhill and Shah (2005).

Control Engineering Practice 13:641, in the form that is consistent with the forces. The published flow chart
tests how far OP has moved since its last reversal; noise reverses OP at every sample, so that the stem may
stay behind by more than friction can hold. With a test of the force on the stem instead, with (S + J) / 2 as
the bound after every reversal of OP (reference ``methods.md`` 1.4), the model is the two-state valve
(``two_state``).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from agent.jit import kernel
from agent.physics.valves.two_state import two_state

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from agent.units import FrictionBands


@kernel
def choudhury2005(op: NDArray[np.float64], s: float, j: float, x0: float) -> NDArray[np.float64]:
    """Return the valve positions, OP units, shape (n,).

    A resting stem breaks away when the force on it exceeds (S + J) / 2 and follows OP at the distance
    (S - J) / 2 until OP stops or turns. While OP is NaN the position holds and the stem comes to rest.

    Args:
        op: Controller output, OP units, shape (n,).
        s: Dead band plus stick band S, OP units.
        j: Slip jump J, OP units, 0 <= j <= s.
        x0: Position of the resting stem before the first sample, OP units.
    """
    return two_state(op, (s + j) / 2, (s - j) / 2, x0)


@dataclass(frozen=True, slots=True)
class Choudhury2005:
    """Choudhury's valve."""

    name: str = "choudhury2005"
    reference: str = "Choudhury, Thornhill, Shah, Control Engineering Practice 13 (2005) 641"

    def position(self, op: NDArray[np.float64], bands: FrictionBands, x0: float) -> NDArray[np.float64]:
        """Return the valve positions, OP units, shape (n,)."""
        return choudhury2005(op, bands.s, bands.j, x0)
