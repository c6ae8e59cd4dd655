"""Local stage on the valve alone: random steps, each scored by the processes of a bank around the last best.

The process follows the valve in closed form, so that the trade-off of S with the delay is no ridge to walk
along.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from agent.identify.bank import Bank
from agent.identify.bank_score import best_between, covariances, moves_of, response_sums
from agent.identify.objective import (
    BRISTLES,
    DELAY,
    FIRST,
    J_RATIO,
    LEVEL,
    LOG_DAMPING,
    LOG_REST,
    RIGID,
    STEM_HIGH,
    STEM_LOW,
    S,
    stem_of,
    valve_of,
)
from agent.identify.problem import from_blocks, to_blocks
from agent.jit import kernel
from agent.physics.valves.damped_stem import GIVE

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray

DELAYS_AROUND = 3


@kernel
def climb(
    candidate: FloatArray,
    bank: Bank,
    grid: tuple[int, int],
    place: int,
    op_span: float,
    scale: float,
    evaluations: int,
    rng: np.random.Generator,
) -> tuple[FloatArray, float, int]:
    """Return the best candidate met and its explained share of PV; the start is evaluated first."""
    m = bank.op.size // bank.block
    means = np.empty(m)
    at = np.empty(m, np.int64)
    by = np.empty(m)
    taus, ratios = grid
    delay = to_blocks(candidate[DELAY], bank.block)
    best = candidate.copy()
    most = -1.0
    failures = 0
    longest = bank.sums.shape[0] - m - 2
    for step in range(evaluations):
        trial = best.copy()
        if step > 0:
            disturb(trial, best, scale, op_span, rng)
        row, column = divmod(place, taus)
        around = np.array(
            [
                place,
                row * taus + max(0, column - 1),
                row * taus + min(taus - 1, column + 1),
                max(0, row - 1) * taus + column,
                min(ratios - 1, row + 1) * taus + column,
            ]
        )
        low = max(
            1 if bank.block == 1 else 0, min(int(delay) - DELAYS_AROUND + 1, longest - 2 * DELAYS_AROUND)
        )
        delays = np.arange(low, low + 2 * DELAYS_AROUND)
        response = np.empty((4, delays.size, around.size))
        covariance = np.empty((delays.size, around.size))
        position = stem_of(valve_of(trial), bank.op)
        moves = moves_of(position, bank.block, means, at, by)
        response_sums(
            means,
            bank.keep,
            bank.poles[around],
            bank.second[around],
            bank.gains[around],
            delays,
            bank.burn,
            response,
        )
        covariances(at, by, moves, bank.sums, around, delays, covariance)
        share, trial_delay, which = best_between(response, covariance, delays, bank)
        if share > most:
            best, most = trial, share
            delay = trial_delay
            place = around[which]
            failures = 0
        else:
            failures += 1
            if failures > 8:
                scale *= 0.6
                failures = 0
    best[DELAY] = max(1.0, from_blocks(delay, bank.block))
    return best, most, place


@kernel
def disturb(
    trial: FloatArray, best: FloatArray, scale: float, op_span: float, rng: np.random.Generator
) -> None:
    """Take a random step in the valve; ``scale`` 1 is 1.5 % of the OP span in S."""
    kind = rng.integers(0, 7 if best[LOG_REST] > RIGID else 5)
    s, j = best[S], best[S] * best[J_RATIO]
    if kind in (0, 1, 4):
        s += scale * 0.015 * op_span * rng.standard_normal()
    if kind == 1:
        j = s * best[J_RATIO]
    if kind in (2, 4):
        j += scale * 0.04 * op_span * rng.standard_normal()
    s = min(max(s, 0.002 * op_span), op_span)
    trial[S] = s
    trial[J_RATIO] = min(max(j / s, 0.0), 1.0)
    if kind in (0, 4):
        trial[LEVEL] += 0.5 * best[FIRST] * (s - best[S])
    if kind in (3, 4):
        trial[LEVEL] += scale * 0.015 * op_span * rng.standard_normal()
    if kind > 3 and best[LOG_REST] > RIGID:
        for axis in range(3):
            if kind in (4, 5 + axis % 2):
                moved = trial[LOG_DAMPING + axis] + 0.7 * scale * rng.standard_normal()
                trial[LOG_DAMPING + axis] = min(max(moved, STEM_LOW[axis]), STEM_HIGH[axis])
        if kind != 5 and best[BRISTLES] > 0.0:
            moved = best[BRISTLES] * np.exp(0.7 * scale * rng.standard_normal())
            trial[BRISTLES] = min(max(moved, GIVE[0]), GIVE[1])
