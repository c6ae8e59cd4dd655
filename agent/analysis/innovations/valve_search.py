"""A sticking valve that makes a whitened record likely: a coarse grid, then random steps.

The search of ``free_run`` looks behind a filter that hides what takes longer than an oscillation. Here few
slips decide, and wide basins: a coarse grid reaches them. Behind each filter another valve stands out, and
which of them is the noise of the record is only known with the valve: so the grid is searched behind all.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.innovations.local_search import random_steps
from agent.analysis.innovations.valve_grid import scan_rests
from agent.analysis.innovations.whitened import Fit, fitted, white_likelihood
from agent.analysis.quantify.free_run.problem import structures
from agent.identify.bank import bank
from agent.identify.first_slip import first_slip
from agent.identify.objective import (
    BRISTLES,
    DELAY,
    FIRST,
    FOPDT,
    INTEGRATOR,
    J_RATIO,
    LEVEL,
    LOG_DAMPING,
    LOG_TAU,
    LOG_TAU2,
    SIZE,
    S,
)
from agent.identify.problem import from_blocks, to_blocks
from agent.identify.search.grid import STEMS
from agent.identify.search.process_bank import processes_of

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from numpy.typing import NDArray

    from agent.analysis.record.recording import FloatArray, LoopHints
    from agent.identify.problem import Problem

S_SHARES = np.geomspace(0.02, 1.0, 18)
"""S of the grid, OP spans."""
J_RATIOS = np.array([0.0, 0.3, 0.9])
REST_STEP, FINE_STEP = 0.04, 0.01
"""Steps of the stem's first rest, OP spans: of the grid, and for the S and J that are given."""
LAGS = 3
ALL = 1e9
"""Periods of a record that is looked at as a whole."""
DELAYS = 8
RIGID = STEMS[0]
"""He's valve."""
STARTS = 4
"""Cells that go on, of the grid and of what is given, behind each filter."""
FINALISTS, WINNERS = 6, 2
"""Valves that are looked at behind all filters, and those that then take more steps."""


def best_valve(
    whitened: Sequence[Problem], hints: LoopHints, given: tuple[float, float] | None
) -> Fit | None:
    """Return the most likely sticking valve, its process and its noise; None where none moves.

    Args:
        whitened: The record behind each filter.
        hints: What the engineer knows.
        given: S and J of a valve to try as well, OP units.
    """
    rng = np.random.default_rng(0)
    climbed = []
    for noise, problem in enumerate(whitened):
        for structure, candidate in _starts(problem, hints, given):
            fit = fitted(candidate, structure, problem, noise, 30, 0.5)
            if math.isfinite(fit.score):
                climbed.append(_stepped(fit, problem, 0.3, 60, rng))
    everywhere = [
        fitted(fit.candidate, fit.structure, each, noise, 40, 0.5)
        for fit in sorted(climbed, key=lambda fit: -fit.score)[:FINALISTS]
        for noise, each in enumerate(whitened)
    ]
    winners = []
    for fit in sorted(everywhere, key=lambda fit: -fit.score)[:WINNERS]:
        problem = whitened[fit.noise]
        stepped = _stepped(fit, problem, 0.2, 150, rng)
        winners += [stepped, fitted(stepped.candidate, fit.structure, problem, fit.noise, 60, 0.3)]
    return max(winners, key=lambda fit: fit.score, default=None)


def _stepped(fit: Fit, problem: Problem, scale: float, steps: int, rng: np.random.Generator) -> Fit:
    """Let the valve take random steps."""
    error = math.exp(-2 * fit.score / problem.weight.sum()) * problem.weight.sum()
    candidate, error = random_steps(fit.candidate, float(error), scale, fit.structure, problem, steps, rng)
    return Fit(white_likelihood(float(error), problem), fit.noise, fit.structure, candidate)


def _starts(
    problem: Problem, hints: LoopHints, given: tuple[float, float] | None
) -> Iterator[tuple[int, FloatArray]]:
    """Yield the best cells of the grid, and of the rests for the valve that is given."""
    yield from _cells(problem, hints, S_SHARES * problem.op_span, J_RATIOS, REST_STEP)
    if given is not None and given[0] > 0:
        s, j = given
        yield from _cells(problem, hints, np.array([s]), np.array([min(j / s, 1.0)]), FINE_STEP)


def _cells(
    problem: Problem, hints: LoopHints, s_values: FloatArray, j_ratios: FloatArray, rest_step: float
) -> Iterator[tuple[int, FloatArray]]:
    single = tuple(each for each in (FOPDT, INTEGRATOR) if hints.integrating in (None, each == INTEGRATOR))
    processes = processes_of(problem, single, LAGS)
    near = bank(problem, processes.taus, processes.ratios, ALL)
    delays = _delays(problem)
    scores, places, rests = scan_rests(near, RIGID, s_values, j_ratios, rest_step * problem.op_span, delays)
    allowed = structures(hints)
    for cell in np.argsort(-scores, axis=None)[:STARTS]:
        i, j = np.unravel_index(cell, scores.shape)
        if scores[i, j] <= 0:
            return
        tau, delay = divmod(int(places[i, j]), len(delays))
        candidate = np.empty(SIZE)
        candidate[[LOG_TAU, LOG_TAU2]] = processes.log_tau[tau], processes.log_tau2[tau]
        candidate[DELAY] = from_blocks(float(delays[delay]), problem.block)
        if problem.fixed_delay > 0:
            candidate[DELAY] = problem.fixed_delay
        _set_valve(candidate, near.op, float(s_values[i]), float(j_ratios[j]), float(rests[i, j]))
        integrates = processes.structure[tau] == INTEGRATOR
        yield (INTEGRATOR if integrates else FOPDT if FOPDT in allowed else allowed[0]), candidate


def _set_valve(candidate: FloatArray, op: FloatArray, s: float, j_ratio: float, rest: float) -> None:
    """Give a candidate a valve whose stem rests at ``rest`` (OP units) before the record."""
    f_s = s * (1 + j_ratio) / 2
    candidate[S], candidate[J_RATIO] = s, j_ratio
    candidate[LEVEL], candidate[FIRST] = first_slip(op, 2 * f_s, rest + f_s)
    candidate[LOG_DAMPING : LOG_DAMPING + 3] = np.log(RIGID)
    candidate[BRISTLES] = 0.0


def _delays(problem: Problem) -> NDArray[np.int64]:
    """Delays of the grid, blocks, ascending."""
    if problem.fixed_delay > 0:
        return np.array([round(to_blocks(problem.fixed_delay, problem.block))])
    longest = max(3.0, 0.5 * problem.max_delay / problem.block)
    return np.unique(np.round(np.geomspace(1, longest, DELAYS)).astype(np.int64))
