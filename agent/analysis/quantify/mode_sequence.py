"""When a valve jumped: the most probable sequence of rest and jump behind a record.

Stenman, Gustafsson and Forsman (2003) write the valve as x(t) = (1 - q(t)) x(t-1) + q(t) u(t) with q 0 or 1
and seek the sequence q with a bank of filters: every sample the most probable branch divides into one that
rests and one that jumps, and the least probable branch that is not too young is dropped.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from agent.jit import kernel
from agent.physics.processes.arx import Arx

if TYPE_CHECKING:
    from numpy.typing import NDArray

BRANCHES = 48
"""Sequences that are kept."""
YOUNG = 24
"""Samples for which a branch is kept whatever it costs: PV must have time to answer to its jump."""


@kernel
def mode_sequence(
    op: NDArray[np.float64], pv: NDArray[np.float64], process: Arx, variance: float, price: float
) -> NDArray[np.float64]:
    """Return the positions of the most probable sequence, OP units, (n,).

    All NaN where no stretch is known from which the process could start. Where the valve stood before is not
    known: the first branches stand all over the range of OP. PV does not tell what the valve does in the
    last D samples, so it rests then, and while OP is NaN.

    Args:
        op: Controller output, OP units, shape (n,).
        pv: Process variable, PV units, shape (n,); NaN says nothing.
        process: The process behind the valve, in free run.
        variance: Mean squared error that noise makes, PV units squared.
        price: What a jump costs, -2 log of its prior odds.
    """
    n = pv.size
    first = process.delay + 1
    while first < n and np.isnan(pv[first - 1] + pv[first - 2] + op[first - process.delay]):
        first += 1
    if first >= n:
        return np.full(n, np.nan)
    stems = np.empty((BRANCHES, n))
    last = np.full(BRANCHES, pv[first - 1])
    before_last = np.full(BRANCHES, pv[first - 2])
    cost = np.zeros(BRANCHES)
    born = np.full(BRANCHES, first - YOUNG)
    low, high = np.nanmin(op), np.nanmax(op)
    for branch in range(BRANCHES):
        stems[branch, : first - process.delay] = low + (high - low) * branch / (BRANCHES - 1)
    for t in range(first, n):
        k = t - process.delay
        likely = np.argmin(cost)
        dropped = -1
        if not np.isnan(op[k]):
            for branch in range(BRANCHES):
                old = born[branch] <= t - YOUNG and branch != likely
                if old and (dropped < 0 or cost[branch] > cost[dropped]):
                    dropped = branch
            stems[dropped, :k] = stems[likely, :k]
            last[dropped] = last[likely]
            before_last[dropped] = before_last[likely]
            cost[dropped] = cost[likely] + price
            born[dropped] = t
        for branch in range(BRANCHES):
            stems[branch, k] = op[k] if branch == dropped else stems[branch, k - 1]
            forced = process.b1 * stems[branch, k] + process.b2 * stems[branch, k - 1] + process.bias
            y = process.a1 * last[branch] + process.a2 * before_last[branch] + forced
            before_last[branch] = last[branch]
            last[branch] = y
            if not np.isnan(pv[t]):
                cost[branch] += (pv[t] - y) ** 2 / variance
    best: NDArray[np.float64] = stems[np.argmin(cost)]
    best[n - process.delay :] = best[n - process.delay - 1]
    return best
