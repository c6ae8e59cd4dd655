"""Valves of an effect of hysteresis, all over its bands, behind a process that is known already.

The quantifier's search finds valves that are alike in both directions, in loops that reverse often. Where OP
moves seldom, or friction differs between the directions, it may find none that is near; but the process of
the valve that it did find is nearly right, and with the process kept a free run costs 50 microseconds.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from agent.workbench.search import by_slopes, hypercube, of_last_effect

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray
    from agent.workbench.objective import Objective

POINTS = 6000
"""That are looked at."""
FOLLOWED, KEPT = 12, 3
"""Of these, by slopes with all free, and of their ends."""
NARROWEST, WIDEST = 0.005, 0.5
"""Of a band, part of OP's span: spread by its logarithm, for a narrow one has as narrow a minimum."""


def scanned(objective: Objective, at: FloatArray) -> FloatArray:
    """Return points of the unit cube, (m, k), with least errors in free run, best first.

    Args:
        objective: Of a model whose last effect is hysteresis.
        at: A point, (k,), with the process that is kept.
    """
    own = np.flatnonzero(of_last_effect(objective))
    points = np.tile(at, (POINTS, 1))
    points[:, own] = hypercube(POINTS, len(own))
    for place in own:
        parameter = objective.space.parameters[place]
        if parameter.unit == "OP" and not parameter.of_record:
            spread = NARROWEST * (WIDEST / NARROWEST) ** points[:, place]
            points[:, place] = spread * objective.facts.op_span / parameter.high
    errors = objective.errors(points)
    ends = [by_slopes(objective, points[each]) for each in np.argsort(errors)[:FOLLOWED]]
    ends.sort(key=objective.error)
    return np.array(ends[:KEPT])
