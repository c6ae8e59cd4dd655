"""Other bristles for a valve, with S and J that leave its slips where they are.

Bristles let a stem break away below f_S while OP rises (``damped_stem.left_at_break_away``). So softer ones
with the same S and J move each slip, and the valve with the right ones would have to be met by chance: S, J
and what bristles give lie along a narrow ridge. A step along it changes all three.
"""

from __future__ import annotations

import math

import numpy as np

from agent.identify.arrays import FloatArray
from agent.identify.objective import BRISTLES
from agent.identify.search.anywhere import drawn_bristles
from agent.jit import kernel
from agent.physics.valves.damped_stem import GIVE


@kernel
def move_bristles(
    candidate: FloatArray, bands: FloatArray, z: float, op_speed: float, rng: np.random.Generator
) -> None:
    """Move what bristles give, or make them stiff, or make stiff ones give."""
    give = candidate[BRISTLES]
    if give == 0.0:
        if rng.random() < 0.5:
            give = drawn_bristles(rng)
    elif rng.random() < 0.2:
        give = 0.0
    else:
        give = min(give * math.exp(z), GIVE[1])
    exchange_bristles(candidate, bands, give, op_speed)


@kernel
def exchange_bristles(candidate: FloatArray, bands: FloatArray, give: float, op_speed: float) -> None:
    """Give a candidate other bristles in place, and S and J with which it breaks away at the same force.

    Args:
        candidate: Its S and J are not read, nor written.
        bands: They, moved along in place, OP units, (2,).
        give: Of the bristles that it gets; 0: stiff ones.
        op_speed: How far OP moves in a sample, OP units.
    """
    before = loosened(bands[1], candidate[BRISTLES], op_speed)
    by = loosened(bands[1], give, op_speed) - before
    by = loosened(bands[1] + by, give, op_speed) - before  # of the J that this needs
    bands[0] += by
    bands[1] += by
    candidate[BRISTLES] = give


@kernel
def loosened(jump: float, give: float, step: float) -> float:
    """Return how far below f_S bristles let a stem break away, OP units, while OP steps by ``step``."""
    jump = max(jump, 0.0)
    lead = 3.0 * np.cbrt(jump * give**2)  # as in ``damped_stem.left_at_break_away``
    nearest = min(8.0 / 27.0 * lead**3, step)
    return float(min(lead * np.cbrt(nearest) ** 2 - nearest, jump))
