"""Sticking valve whose stem takes its time and may slide on: an overdamped stem in a packing.

A slip is not over at once: viscous damping leaves a part ``lag`` of the way after one sample, and whether
the stem is at rest when OP moves again decides whether it must break away again. He's model (``he2007``)
rests after every slip, Kano's and the two-state model (``two_state``) slide on as long as OP goes on; a real
stem is between, by how far a slip goes. Derived from Karnopp's law with negligible inertia and OP held
between samples.
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
def damped_stem(
    op: NDArray[np.float64], f_s: float, f_d: float, x0: float, lag: float, rest: float
) -> NDArray[np.float64]:
    """Return the valve positions, OP units, shape (n,).

    Args:
        op: Controller output, OP units, shape (n,).
        f_s: Static friction band, OP units.
        f_d: Kinetic friction band, OP units, 0 <= f_d <= f_s.
        x0: Position of the resting stem before the first sample, OP units.
        lag: Part of its way that the stem has left after a sample, 0 to 1.
        rest: Way in a sample, OP units, up to which the stem is at rest at its end; infinity gives He's model
            and zero the two-state one, both with ``lag`` 0.
    """
    position = np.empty(op.size)
    x = x0
    moving = 0.0  # direction of motion, 0 at rest
    for t in range(op.size):
        if not moving * (op[t] - moving * f_d - x) > 0.0:
            moving = 0.0
            if op[t] - x > f_s:
                moving = 1.0
            elif x - op[t] > f_s:
                moving = -1.0
        if moving != 0.0:
            balance = op[t] - moving * f_d
            way = moving * (balance - x)
            x = balance - lag * (balance - x)
            if way <= rest:
                moving = 0.0
        position[t] = x
    return position


@dataclass(frozen=True, slots=True)
class DampedStem:
    """The damped stem."""

    name: str = "damped_stem"
    reference: str = "after Karnopp, J. of Dynamic Systems, Measurement, and Control 107 (1985) 100"
    lag: float = 0.1
    """Part of its way that the stem has left after a sample, 0 to 1.

    0.1 is a stem with a time constant of 0.43 s, sampled at 1 s.
    """
    rest: float = 0.1
    """Way in a sample up to which the stem is at rest at its end, share of f_S."""

    def position(self, op: NDArray[np.float64], bands: FrictionBands, x0: float) -> NDArray[np.float64]:
        """Return the valve positions, OP units, shape (n,)."""
        return damped_stem(op, bands.f_s, bands.f_d, x0, self.lag, self.rest * bands.f_s)
