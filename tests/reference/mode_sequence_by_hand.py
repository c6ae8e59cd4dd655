"""The filter bank over rest and jump, one branch an object."""

import numpy as np

from agent.analysis.quantify.mode_sequence import BRANCHES, YOUNG


def mode_sequence(op, pv, process, variance, price):
    n, delay = len(pv), process.delay
    first = next(
        (t for t in range(delay + 1, n) if np.isfinite([pv[t - 1], pv[t - 2], op[t - delay]]).all()), None
    )
    if first is None:
        return np.full(n, np.nan)
    bank = [
        {"stem": [level] * (first - delay), "past": [pv[first - 2], pv[first - 1]], "cost": 0.0, "born": -n}
        for level in np.linspace(np.nanmin(op), np.nanmax(op), BRANCHES)
    ]
    for t in range(first, n):
        likely = min(bank, key=lambda branch: branch["cost"])
        jumped = None
        if np.isfinite(op[t - delay]):
            old = [branch for branch in bank if branch["born"] <= t - YOUNG and branch is not likely]
            dropped = max(old, key=lambda branch: branch["cost"])
            jumped = {
                "stem": list(likely["stem"]),
                "past": list(likely["past"]),
                "cost": likely["cost"] + price,
                "born": t,
            }
            bank[next(i for i, branch in enumerate(bank) if branch is dropped)] = jumped
        for branch in bank:
            x1, x2 = op[t - delay] if branch is jumped else branch["stem"][-1], branch["stem"][-1]
            y2, y1 = branch["past"]
            y = process.a1 * y1 + process.a2 * y2 + process.b1 * x1 + process.b2 * x2 + process.bias
            branch["stem"].append(x1)
            branch["past"] = [y1, y]
            branch["cost"] += 0.0 if np.isnan(pv[t]) else (pv[t] - y) ** 2 / variance
    best = min(bank, key=lambda branch: branch["cost"])["stem"]
    return np.array(best + [best[-1]] * delay)
