"""The laws of the valve that the compiled searches try, all by f_S and f_D.

Stenman's one-parameter valve is He's with f_D = 0.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from agent.jit import kernel
from agent.physics.valves.choudhury2005 import choudhury2005
from agent.physics.valves.he2007 import he2007
from agent.physics.valves.kano2004 import kano2004

if TYPE_CHECKING:
    from numpy.typing import NDArray

HE, CHOUDHURY, KANO = 0, 1, 2
"""Laws; a number, since the compiled code is then the same for all."""


@kernel
def stem_position(
    op: NDArray[np.float64], f_s: float, f_d: float, x0: float, law: int
) -> NDArray[np.float64]:
    """Return the positions of a valve of one of the laws, OP units, (n,); bands and ``x0`` in OP units."""
    s, j = f_s + f_d, f_s - f_d
    if law == CHOUDHURY:
        return choudhury2005(op, s, j, x0)
    if law == KANO:
        return kano2004(op, s, j, s, j, x0)
    return he2007(op, f_s, f_d, x0)


@kernel
def valve_position(op: NDArray[np.float64], f_s: float, f_d: float, law: int) -> NDArray[np.float64]:
    """Return MV', the position from a start without stored force about its mean, OP units, (n,).

    It is NaN where OP is missing: what the valve did then is not known.
    """
    first = 0
    while np.isnan(op[first]):
        first += 1
    # From its start the position of a valve that never moves is exactly zero, and stays so less its mean.
    position = stem_position(op - op[first], f_s, f_d, 0.0, law)
    for t in range(op.size):
        if np.isnan(op[t]):
            position[t] = np.nan
    return position - np.nanmean(position)
