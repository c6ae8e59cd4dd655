"""Valves from anywhere, each scored by a bank of processes: where a search begins."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from agent.identify.arrays import FloatArray, IntArray
from agent.identify.bank import Bank, bank
from agent.identify.bank_score import best_share, room_for
from agent.identify.bounds import keep_in_bounds
from agent.identify.first_slip import first_slip
from agent.identify.objective import (
    BRISTLES,
    DELAY,
    FIRST,
    J_RATIO,
    LEVEL,
    LOG_DAMPING,
    LOG_TAU,
    LOG_TAU2,
    SIZE,
    STEM_HIGH,
    STEM_LOW,
    S,
)
from agent.identify.problem import Problem, from_blocks
from agent.identify.search.population import Candidates
from agent.identify.search.process_bank import Processes, delays_of, processes_of
from agent.identify.side_by_side.positions import alike, fill_positions, group_for
from agent.identify.slices import in_slices
from agent.jit import kernel
from agent.lanes import WIDTH
from agent.physics.valves.damped_stem import GIVE

if TYPE_CHECKING:
    from collections.abc import Sequence

LEAST_S = 0.01
"""Smallest S that is drawn, over the OP span: a smaller one no record shows."""
LAGS, DELAYS, FARTHEST = 4, 8, 0.6
"""Time constants and delays of the bank, and its longest delay over the longest there is."""
SOFT = 1 / 3
"""Share of the stems with bristles."""
LEAST_MOVES = 3
"""Blocks in which a valve that is looked at moves."""
ALL = 1e9
"""Periods of a bank over all that is given."""


def valves_from_anywhere(
    count: int,
    problem: Problem,
    part: Problem,
    structures: Sequence[int],
    rng: np.random.Generator,
) -> Candidates:
    """Return random valves over the ``part`` of a record, each with its best process of a bank.

    Args:
        count: How many.
        problem: The whole record.
        part: Its first periods.
        structures: Processes that are possible.
        rng: Where chance comes from.
    """
    processes = processes_of(problem, structures, LAGS)
    near = bank(part, processes.taus, processes.ratios, ALL)
    delays = delays_of(problem, DELAYS, FARTHEST)
    valves = drawn(count, part, near, rng)
    in_slices(lambda begin, end: score(valves, part, near, delays, processes, begin, end), 0, count)
    return valves


@kernel
def drawn(count: int, part: Problem, bank: Bank, rng: np.random.Generator) -> Candidates:
    """Draw valves; they have no process yet."""
    candidates = np.zeros((count, SIZE))
    early = bank.op[: min(bank.op.size, bank.early)]
    low, high = early.min(), early.max()
    for i in range(count):
        draw_valve(candidates[i], low, high, part, rng)
    return Candidates(candidates, np.zeros(count, np.int64), np.full(count, np.inf))


@kernel
def score(
    valves: Candidates,
    part: Problem,
    bank: Bank,
    delays: IntArray,
    processes: Processes,
    begin: int,
    end: int,
) -> None:
    """Give some of the valves, in place, the process of the bank that explains most of PV behind each."""
    candidates, structures, costs = valves
    room, group = room_for(bank, delays), group_for(part)
    squares = np.dot(part.pv, part.pv)
    order = alike(candidates, begin, end)
    for first in range(0, order.size, WIDTH):
        places = order[first : first + WIDTH]
        fill_positions(candidates, places, part, group)
        for lane in range(places.size):
            i = places[lane]
            position = group.positions[: bank.op.size, lane].copy()
            share, place = best_share(position, bank, delays, LEAST_MOVES, room)
            k, q = place // delays.size, place % delays.size
            candidates[i, LOG_TAU], candidates[i, LOG_TAU2] = processes.log_tau[k], processes.log_tau2[k]
            candidates[i, DELAY] = from_blocks(float(delays[q]), part.block)
            keep_in_bounds(candidates[i], part)
            structures[i] = processes.structure[k]
            costs[i] = (1.0 - share) * squares


@kernel
def draw_valve(
    candidate: FloatArray, low: float, high: float, problem: Problem, rng: np.random.Generator
) -> None:
    """Give a candidate a valve from anywhere: S and J/S half evenly, half by logarithms; any stem.

    ``low`` and ``high``: range of OP in the first strokes, in which a valve that slips first slips.
    """
    span = problem.op_span
    share = even_or_logarithmic(LEAST_S, rng)
    s = share * span
    candidate[S] = s
    candidate[J_RATIO] = even_or_logarithmic(LEAST_S, rng)
    up = high - 0.01 * span * rng.random()
    if s < high - low:
        up = low + s + (high - low - s) * rng.random()
    candidate[LEVEL], candidate[FIRST] = first_slip(problem.op, s, up)
    draw_stem(candidate, rng)
    candidate[BRISTLES] = drawn_bristles(rng) if rng.random() < SOFT else 0.0


@kernel
def even_or_logarithmic(least: float, rng: np.random.Generator) -> float:
    """Return a share up to 1: half of the draws even, half with an even logarithm from ``least`` on."""
    u = rng.random()
    if rng.random() < 0.5:
        return float(least + (1.0 - least) * u)
    return float(least ** (1.0 - u))


@kernel
def draw_stem(candidate: FloatArray, rng: np.random.Generator) -> None:
    """Give a candidate any damping, supply and rest."""
    for axis in range(3):
        low, high = STEM_LOW[axis], STEM_HIGH[axis]
        candidate[LOG_DAMPING + axis] = low + (high - low) * rng.random()


@kernel
def drawn_bristles(rng: np.random.Generator) -> float:
    """Return what bristles may give, by logarithms."""
    return float(GIVE[0] * (GIVE[1] / GIVE[0]) ** rng.random())
