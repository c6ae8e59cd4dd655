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
"""Samples for which a branch is kept whatever it costs: PV must have time to respond to its jump."""


@kernel
def mode_sequence(
    op: NDArray[np.float64], pv: NDArray[np.float64], process: Arx, variance: float, price: float
) -> NDArray[np.float64]:
    """Return the positions of the most probable sequence, OP units, (n,).

    All NaN where no stretch is known from which the process could start. Where the valve stood before is not
    known: the first branches stand all over the range of OP. PV does not show the valve's motion in the
    last D samples, so it rests then, and while OP is NaN.

    Args:
        op: Controller output, OP units, shape (n,).
        pv: Process variable, PV units, shape (n,); NaN is missing.
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
    # A jump is a node with its time and the jump before it; the branches are leaves of this tree.
    jumped_at = np.zeros(BRANCHES + n, dtype=np.int64)
    before = np.full(BRANCHES + n, -1)
    nodes = BRANCHES
    leaf = np.arange(BRANCHES)
    stem = np.linspace(np.nanmin(op), np.nanmax(op), BRANCHES)
    start = stem.copy()
    last = np.full(BRANCHES, pv[first - 1])
    before_last = np.full(BRANCHES, pv[first - 2])
    cost = np.zeros(BRANCHES)
    born = np.full(BRANCHES, first - YOUNG)
    for t in range(first, n):
        k = t - process.delay
        likely = np.argmin(cost)
        dropped = -1
        if not np.isnan(op[k]):
            for branch in range(BRANCHES):
                old = born[branch] <= t - YOUNG and branch != likely
                if old and (dropped < 0 or cost[branch] > cost[dropped]):
                    dropped = branch
            jumped_at[nodes], before[nodes] = k, leaf[likely]
            leaf[dropped] = nodes
            nodes += 1
            stem[dropped] = stem[likely]
            last[dropped] = last[likely]
            before_last[dropped] = before_last[likely]
            cost[dropped] = cost[likely] + price
            born[dropped] = t
        for branch in range(BRANCHES):
            position = op[k] if branch == dropped else stem[branch]
            forced = process.b1 * position + process.b2 * stem[branch] + process.bias
            y = process.a1 * last[branch] + process.a2 * before_last[branch] + forced
            stem[branch] = position
            before_last[branch] = last[branch]
            last[branch] = y
            if not np.isnan(pv[t]):
                cost[branch] += (pv[t] - y) ** 2 / variance
    positions = np.empty(n)
    end = n
    node = leaf[np.argmin(cost)]
    while before[node] >= 0:
        positions[jumped_at[node] : end] = op[jumped_at[node]]
        end = jumped_at[node]
        node = before[node]
    positions[:end] = start[node]
    return positions
