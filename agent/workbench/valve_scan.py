"""Valves all over S, J and the way the stem moves, and the best of them.

The error over a valve's values is a needle among others, most of all behind a filter that whitens. Simplexes
from a few hundred points meet it seldom. So thousands are looked at, and from the best of them each value by
itself is tried all over its range: of a neighbouring valley often one value is wrong, as the first slip.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from agent.workbench.search import best_of, lowered, of_last_effect, spread_about

if TYPE_CHECKING:
    from agent.analysis.recording import FloatArray
    from agent.workbench.search import Objective, Round

VALVES = 6000
"""That are looked at."""
SMALLEST = 0.003
"""Band, part of its range. Logarithms are spread: uniform in S most valves would not have moved."""
LEAST_LEFT = 0.01
"""Of S beside J, in half of the valves: hardly any kinetic friction is as common as much of it."""
PLACES = 40
"""Of each value by itself."""
MOVED = (-0.2, 0.2)
"""How far half of them move the values of all but the last effect, parts of a parameter's range."""
ROUNDS: tuple[Round, ...] = ((16, 0.05, 12), (6, 0.03, 20), (2, 0.02, 20))
"""As many again go on with one of their values elsewhere."""


def valves(objective: Objective, at: FloatArray) -> list[FloatArray]:
    """Return the best points of the unit cube, (k,), that are found with the last effect, a valve, anywhere.

    All else is searched from near ``at``, (k,). Always the same.
    """
    own = of_last_effect(objective)
    points = spread_about(at, own, MOVED, VALVES)
    parameters = objective.space.parameters
    bands = own & np.array([each.null == 0.0 for each in parameters])
    points[:, bands] = SMALLEST ** (1.0 - points[:, bands])
    shares = own & np.array([(each.low, each.high) == (0.0, 1.0) for each in parameters])
    points[::2, shares] = 1.0 - LEAST_LEFT ** points[::2, shares]
    found = list(points)
    for kept, step, evaluations in ROUNDS:
        best = best_of(objective, np.array(found), kept)
        elsewhere = [_elsewhere(objective, each, np.flatnonzero(own).tolist()) for each in best]
        found = [lowered(objective, each, step, evaluations) for each in (*best, *elsewhere)]
    return found


def _elsewhere(objective: Objective, at: FloatArray, coordinates: list[int]) -> FloatArray:
    """Return the best point that differs from ``at`` (k,) in one of the coordinates."""
    tried = np.tile(at, (PLACES * len(coordinates), 1))
    for i, each in enumerate(coordinates):
        tried[PLACES * i : PLACES * (i + 1), each] = np.linspace(0.0, 1.0, PLACES)
    return best_of(objective, tried, 1)[0]
