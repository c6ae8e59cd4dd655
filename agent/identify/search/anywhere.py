"""Valves from anywhere, each scored by a bank of processes: where a search begins."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

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
    FOPDT,
    INTEGRATOR,
    J_RATIO,
    LEAST_LOG_TAU,
    LEVEL,
    LOG_DAMPING,
    LOG_TAU,
    LOG_TAU2,
    SIZE,
    SOPDT,
    STEM_HIGH,
    STEM_LOW,
    S,
    valve_position,
)
from agent.identify.problem import Problem, from_blocks, to_blocks
from agent.identify.search.population import Candidates
from agent.jit import kernel
from agent.physics.valves.damped_stem import GIVE

if TYPE_CHECKING:
    from collections.abc import Sequence

LEAST_S = 0.01
"""Smallest S that is drawn, over the OP span: a smaller one no record shows."""
TAUS = 5
RATIO = 0.6
"""Of the second time constant to the first, in the bank: between one lag and two equal ones."""
SOFT = 1 / 3
"""Share of the stems with bristles."""
LEAST_MOVES = 3
"""Blocks in which a valve that is looked at moves."""
ALL = 1e9
"""Periods of a bank over all that is given."""


class Processes(NamedTuple):
    """Processes of a bank, for kernels."""

    log_tau: FloatArray
    """samples, (k,)"""
    log_tau2: FloatArray
    structure: IntArray


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
    taus, ratios = process_bank(problem, structures)
    near = bank(part, taus, ratios, ALL)
    lags = ~np.isinf(taus)
    structure = np.where(lags, np.where(ratios > 0, SOPDT, FOPDT), INTEGRATOR).astype(np.int64)
    log_tau = np.log(np.where(lags, taus, math.exp(2.0)))
    log_tau2 = np.where(ratios > 0, log_tau + np.log(np.maximum(ratios, 1e-3)), LEAST_LOG_TAU)
    processes = Processes(log_tau, np.maximum(log_tau2, LEAST_LOG_TAU), structure)
    return scored(count, part, near, delays_of(problem), processes, rng)


def process_bank(problem: Problem, structures: Sequence[int]) -> tuple[FloatArray, FloatArray]:
    """Return time constants (samples, infinite for an integrator) and ratios of the second to it, (k,)."""
    slowest = max(6.0, problem.period)
    lags = np.geomspace(max(0.7, 0.5 * problem.block), slowest, TAUS - 1)
    taus: list[float] = []
    ratios: list[float] = []
    for structure, ratio in ((FOPDT, 0.0), (SOPDT, RATIO)):
        if structure in structures:
            taus += list(lags)
            ratios += [ratio] * len(lags)
    if INTEGRATOR in structures:
        taus.append(math.inf)
        ratios.append(0.0)
    return np.array(taus), np.array(ratios)


def delays_of(problem: Problem) -> IntArray:
    """Return the delays of the bank, blocks, ascending."""
    first = 1 if problem.block == 1 else 0
    if problem.fixed_delay > 0:
        return np.array([round(to_blocks(problem.fixed_delay, problem.block))])
    longest = 0.6 * problem.max_delay / problem.block
    steps = np.concatenate([np.arange(3), np.geomspace(3, max(5.0, longest), 5)])
    return first + np.unique(np.round(steps).astype(np.int64))


@kernel
def scored(
    count: int,
    part: Problem,
    bank: Bank,
    delays: IntArray,
    processes: Processes,
    rng: np.random.Generator,
) -> Candidates:
    """Draw valves and give each the process of the bank that explains most of PV behind it."""
    candidates = np.zeros((count, SIZE))
    structures = np.zeros(count, np.int64)
    costs = np.full(count, np.inf)
    room = room_for(bank, delays)
    squares = np.dot(part.pv, part.pv)
    early = bank.op[: min(bank.op.size, bank.early)]
    low, high = early.min(), early.max()
    for i in range(count):
        candidate = candidates[i]
        draw_valve(candidate, low, high, part, rng)
        position = valve_position(candidate, part)[: bank.op.size]
        share, place = best_share(position, bank, delays, LEAST_MOVES, room)
        k, q = place // delays.size, place % delays.size
        candidate[LOG_TAU], candidate[LOG_TAU2] = processes.log_tau[k], processes.log_tau2[k]
        candidate[DELAY] = from_blocks(float(delays[q]), part.block)
        keep_in_bounds(candidate, part)
        structures[i] = processes.structure[k]
        costs[i] = (1.0 - share) * squares
    return Candidates(candidates, structures, costs)


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
