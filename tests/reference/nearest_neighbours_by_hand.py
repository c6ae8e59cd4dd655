"""The prediction from nearest neighbours, stretch by stretch as the formula says."""

import numpy as np


def prediction_error(x, cycle, neighbours):
    ahead = 2 * cycle - 1
    stretches = [x[t : t + cycle] for t in range(len(x) - ahead)]
    total = 0.0
    for t, now in enumerate(stretches):
        others = [
            (float(np.sum((now - other) ** 2)), u) for u, other in enumerate(stretches) if abs(t - u) > cycle
        ]
        nearest = [u for _, u in sorted(others)[:neighbours]]
        total += (np.mean([x[u + ahead] for u in nearest]) - x[t + ahead]) ** 2
    return total
