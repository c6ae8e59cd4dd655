"""Which of a population stand apart, written for the eye."""

import numpy as np
from agent.analysis.quantify.free_run.evolution import SAME

from agent.identify.objective import FIRST


def apart(people, most, distance, ranges):
    """Return the best that differ from all better ones that were taken."""
    taken = []
    for i in np.argsort(people.errors):
        if np.isfinite(people.errors[i]) and all(differ(people, i, k, distance, ranges) for k in taken):
            taken.append(int(i))
    return taken[:most]


def differ(people, worse, better, distance, ranges):
    """Whether two differ in error, and in structure, first slip or a coordinate."""
    if people.errors[worse] <= (1 + SAME) * people.errors[better]:
        return False
    one, other = people.candidates[worse], people.candidates[better]
    if people.structures[worse] != people.structures[better] or one[FIRST] != other[FIRST]:
        return True
    searched = ranges > 0
    return bool(np.any((np.abs(one - other) / np.where(searched, ranges, 1.0))[searched] > distance))
