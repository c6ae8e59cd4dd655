"""Global stage: every (S, J/S, level of the first slip) on a grid, scored by a bank of processes.

Minima are needles, but a score is cheap. A valve that slips once each way never forgets at which level of OP
it first slipped, so that level is searched like S; levels whose valves meet again within a period and a half
are one.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

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
    S,
)
from agent.identify.problem import Problem, from_blocks
from agent.identify.search.population import S_BINS, Candidates
from agent.identify.search.process_bank import delays_of, processes_of
from agent.identify.slices import in_slices
from agent.jit import kernel
from agent.physics.valves.damped_stem import Motion, stem_at, stem_motion, strokes

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from agent.identify.arrays import FloatArray

LEVEL_STEP = 0.02
"""Step of the level of OP at the first slip, OP spans."""
STEMS = np.array([(0.01, 0.01, 1e-8), (0.15, 0.1, 0.003), (0.3, 0.15, 0.01)])
"""Damping, supply and rest: He's valve, and two that take their time."""
LAGS, DELAYS, FARTHEST = 6, 12, 0.75
"""Time constants and delays of the bank, and its longest delay over the longest there is."""
LOOKS = 6
"""How often in the first period and a half it is seen whether stems have met."""
TOGETHER = 1e-3
"""Distance over f_S within which they have, at the end of it,"""
THE_SAME = 1e-6
"""and before, where both rest: as they go on alike from there, they need not be moved on."""
LEAST_MOVES = 3
"""Of a valve that is looked at."""


class Grid(NamedTuple):
    """The valves that are looked at, and over how long."""

    periods: float
    """More add needles to the haystack, not information at this resolution."""
    s_steps: int
    """To the OP span."""
    j_ratios: FloatArray
    groups: tuple[int, ...]
    """How many of them in a row make a group."""
    per_bin: int
    """Valves kept of each bin of S, group and stem."""

    def group_places(self) -> list[NDArray[np.int64]]:
        """Return the places of each group among ``j_ratios``."""
        return np.split(np.arange(len(self.j_ratios)), np.cumsum(self.groups)[:-1])


COARSE = Grid(8.0, 60, np.array([0.0, 0.04, 0.09, 0.15, 0.25, 0.4, 0.6, 0.8, 0.97]), (5, 4), 5)


def valves_of_grid(problem: Problem, structures: Sequence[int], grid: Grid = COARSE) -> Candidates:
    """Return the best few valves of each bin of S and J for each stem, with processes.

    By bins, because the cells of one broad wrong basin would crowd out the needles. Their costs are the
    shares of PV that they do not explain.

    Args:
        problem: The record.
        structures: Processes that are possible.
        grid: The valves that are looked at.
    """
    s_values = np.linspace(1.0 / grid.s_steps, 1.0, grid.s_steps) * problem.op_span
    processes = processes_of(problem, structures, LAGS)
    delays = delays_of(problem, DELAYS, FARTHEST)
    near = bank(problem, processes.taus, processes.ratios, grid.periods)
    level_step = LEVEL_STEP * problem.op_span
    scores, places, levels = scan(near, STEMS, s_values, grid.j_ratios, level_step, delays)
    cells = best_cells(scores, (s_values / problem.op_span * S_BINS).astype(int), grid)
    candidates = np.empty((len(cells), SIZE))
    structure, shares = np.empty(len(cells), dtype=np.int64), np.empty(len(cells))
    for cell, (k, i, j) in enumerate(cells):
        tau, delay = divmod(int(places[k, i, j]), len(delays))
        candidate = candidates[cell]
        candidate[[LOG_TAU, LOG_TAU2]] = processes.log_tau[tau], processes.log_tau2[tau]
        candidate[DELAY] = from_blocks(float(delays[delay]), problem.block)
        set_valve(candidate, near.op, s_values[i], grid.j_ratios[j], levels[k, i, j], STEMS[k])
        keep_in_bounds(candidate, problem)
        structure[cell], shares[cell] = processes.structure[tau], scores[k, i, j]
    return Candidates(candidates, structure, (1.0 - shares) * float(problem.pv @ problem.pv))


def set_valve(
    candidate: FloatArray, op: FloatArray, s: float, j_ratio: float, up: float, stem: FloatArray
) -> None:
    """Give a candidate a valve that first slips where ``op`` passes ``up`` or S below, and a stem (3,)."""
    candidate[S], candidate[J_RATIO] = s, j_ratio
    candidate[LEVEL], candidate[FIRST] = first_slip(op, s, up)
    candidate[LOG_DAMPING : LOG_DAMPING + 3] = np.log(stem)
    candidate[BRISTLES] = 0.0


def best_cells(scores: FloatArray, bins: NDArray[np.int64], grid: Grid) -> list[tuple[int, int, int]]:
    """Return the best cells (stem, S, J) of each bin of S, group of J and stem."""
    chosen = []
    for one_bin in np.unique(bins):
        rows = np.flatnonzero(bins == one_bin)
        for group in grid.group_places():
            for k in range(len(scores)):
                part = scores[k][np.ix_(rows, group)]
                for cell in np.argsort(-part, axis=None)[: grid.per_bin]:
                    row, column = np.unravel_index(cell, part.shape)
                    if part[row, column] > 0:
                        chosen.append((k, int(rows[row]), int(group[column])))
    return chosen


def scan(
    bank: Bank,
    stems: FloatArray,
    s_values: FloatArray,
    j_ratios: FloatArray,
    level_step: float,
    delays: NDArray[np.int64],
) -> tuple[FloatArray, NDArray[np.int64], FloatArray]:
    """Return explained shares, (stem, S, J), with the place in the bank and the upper level of each.

    Args:
        bank: Of processes.
        stems: Damping, supply and rest of each, (stem, 3).
        s_values: OP units.
        j_ratios: J over S.
        level_step: Between the levels of the first slip, OP units.
        delays: Of the bank, blocks.
    """
    shape = (len(stems), len(s_values), len(j_ratios))
    found = np.zeros(shape), np.zeros(shape, np.int64), np.zeros(shape)
    in_slices(
        lambda begin, end: _scan(bank, stems, s_values, j_ratios, level_step, delays, found, begin, end),
        0,
        len(stems) * len(s_values),
    )
    return found


@kernel
def _scan(
    bank: Bank,
    stems: FloatArray,
    s_values: FloatArray,
    j_ratios: FloatArray,
    level_step: float,
    delays: NDArray[np.int64],
    found: tuple[FloatArray, NDArray[np.int64], FloatArray],
    begin: int,
    end: int,
) -> None:
    """Scan the pairs of a stem and an S from ``begin`` up to ``end``, counted through all stems."""
    scores, places, levels = found
    meeting = min(bank.op.size, bank.early)
    early_op = bank.op[:meeting]
    low = early_op.min()
    high = early_op.max()
    looks = np.array([max(1, (look + 1) * early_op.size // LOOKS) for look in range(LOOKS)])
    room = room_for(bank, delays)
    met = np.empty((LOOKS, int((high - low) / level_step) + 4))
    position = np.empty(bank.op.size)
    for pair in range(begin, end):
        k, i = pair // s_values.size, pair % s_values.size
        motion = stem_motion(stems[k, 0], stems[k, 1], stems[k, 2])
        for j in range(j_ratios.size):
            f_s = s_values[i] * (1.0 + j_ratios[j]) / 2.0
            f_d = s_values[i] * (1.0 - j_ratios[j]) / 2.0
            bands = (f_s, f_s, f_d)
            n_met = 0
            count = max(1, int((high - low - s_values[i]) / level_step))
            for r in range(count):
                up = low + s_values[i] + (high - low - s_values[i]) * (r + 0.5) / count
                if s_values[i] > high - low:
                    up = high - 0.5 * level_step
                level, direction = first_slip(bank.op, s_values[i], up)
                state = stem_at(level - direction * f_s, bank.op[0])
                if meets(bank.op, looks, state, bands, motion, position, met, n_met, TOGETHER):
                    continue
                n_met += 1
                strokes(bank.op, looks[-1], bank.op.size, state, bands, motion, position, bank.op.size)
                best, place = best_share(position, bank, delays, LEAST_MOVES, room)
                if best > scores[k, i, j]:
                    scores[k, i, j], places[k, i, j], levels[k, i, j] = best, place, up


@kernel
def meets(
    op: FloatArray,
    looks: NDArray[np.int64],
    state: FloatArray,
    bands: tuple[float, float, float],
    motion: Motion,
    position: FloatArray,
    met: FloatArray,
    n_met: int,
    together: float,
) -> bool:
    """Move a stem on until it stands where one before stood at the same time, and return whether it did.

    Args:
        op: OP units, (n,).
        looks: Samples before which it is looked at, (k,).
        state: Of the stem at the start of the record (``stem_at``), moved on, (5,).
        bands: As ``strokes`` takes them.
        motion: Likewise.
        position: Takes its way, OP units, (n,).
        met: Where stems before stood at each look, OP units, NaN where they moved, (k, more than ``n_met``);
            takes that of this one.
        n_met: Number of stems before.
        together: Distance over f_S that is enough at the last look, also of stems that move; 0: none is.
    """
    t = 0
    for look in range(looks.size):
        strokes(op, t, looks[look], state, bands, motion, position, op.size)
        t = looks[look]
        last = together > 0.0 and look + 1 == looks.size
        met[look, n_met] = state[0] if last or state[2] == 0.0 else math.nan
        apart = (together if last else THE_SAME) * bands[0]
        for other in range(n_met):
            if abs(met[look, other] - met[look, n_met]) <= apart:
                return True
    return False
