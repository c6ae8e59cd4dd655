"""Sticking valve with one parameter: Stenman, Gustafsson and Forsman (2003).

Int. J. of Adaptive Control and Signal Processing 17:625. It is He's valve (``he2007``) without kinetic
friction: S = J = f_S.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from agent.jit import kernel
from agent.physics.valves.he2007 import he2007

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from agent.units import FrictionBands


@kernel
def stenman2003(op: NDArray[np.float64], d: float, x0: float) -> NDArray[np.float64]:
    """Return the valve positions, OP units, shape (n,).

    The stem rests as long as OP is within ``d`` of it and otherwise jumps to OP. While OP is NaN the
    position holds.

    Args:
        op: Controller output, OP units, shape (n,).
        d: Valve stiction band, OP units.
        x0: Position before the first sample, OP units.
    """
    return he2007(op, d, 0.0, x0)


@dataclass(frozen=True, slots=True)
class Stenman2003:
    """Stenman's valve with d = f_S; it has no f_D."""

    name: str = "stenman2003"
    reference: str = (
        "Stenman, Gustafsson, Forsman, Int. J. of Adaptive Control and Signal Processing 17 (2003) 625"
    )

    def position(self, op: NDArray[np.float64], bands: FrictionBands, x0: float) -> NDArray[np.float64]:
        """Return the valve positions, OP units, shape (n,)."""
        return stenman2003(op, bands.f_s, x0)
