"""Valves all over S, J and the way the stem moves, and the best of them.

The error over a valve's values is a needle among others, most of all behind a filter that whitens. Simplexes
from a few hundred points meet it seldom. So thousands are looked at over the first part of the record, and
what is left of them is followed to all of it (``growing_horizon.py``).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from agent.workbench.growing_horizon import followed
from agent.workbench.search import of_effect, spread_about

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray
    from agent.workbench.search import Whitened

VALVES = 16000
"""That are looked at."""
SMALLEST = 0.003
"""Band, part of its range. Logarithms are spread: uniform in S most valves would not have moved."""
LEAST_LEFT = 0.01
"""Of S beside J, in half of the valves: hardly any kinetic friction is as common as much of it."""
MOVED = (-0.2, 0.2)
"""How far half of them move the values of all else, parts of a parameter's range."""
BEST = 3
"""That are handed on."""


def valves(objective: Whitened, at: FloatArray, valve: str) -> FloatArray:
    """Return the best points of the unit cube, (m, k), that are found with a valve anywhere. Always the same.

    Args:
        objective: What is lowered.
        at: All else is searched from near it, and it is tried as well, (k,).
        valve: Name of the effect.
    """
    own = of_effect(objective, valve)
    points = spread_about(at, own, MOVED, VALVES)
    parameters = objective.space.parameters
    bands = own & np.array([each.null == 0.0 for each in parameters])
    points[:, bands] = SMALLEST ** (1.0 - points[:, bands])
    shares = own & np.array([(each.low, each.high) == (0.0, 1.0) for each in parameters])
    points[::2, shares] = 1.0 - LEAST_LEFT ** points[::2, shares]
    return followed(objective, points, at)[:BEST]
