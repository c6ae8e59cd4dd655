"""A sticking valve that makes a whitened record likely: a coarse grid, then random steps.

The search of ``free_run`` looks behind a filter that hides what takes longer than an oscillation. Here few
slips decide, and wide basins: a coarse grid reaches them.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.innovations.whitened import Fit, fitted, white_likelihood
from agent.analysis.quantify.free_run.bank import bank
from agent.analysis.quantify.free_run.coarse_grid import processes, scan, set_process, set_valve
from agent.analysis.quantify.free_run.local_search import random_steps
from agent.analysis.quantify.free_run.objective import (
    DELAY,
    FOPDT,
    INTEGRATOR,
    SIZE,
)
from agent.analysis.quantify.free_run.problem import to_blocks
from agent.analysis.quantify.free_run.search import STEMS, structures

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from numpy.typing import NDArray

    from agent.analysis.quantify.free_run.problem import Problem
    from agent.analysis.recording import FloatArray, LoopHints

S_SHARES = np.geomspace(0.02, 1.0, 18)
"""S of the grid, OP spans."""
J_RATIOS = np.array([0.0, 0.3, 0.9])
LEVEL_STEP, FINE_STEP = 0.04, 0.01
"""Steps of the level of the first slip, OP spans: of the grid, and for the S and J that are told."""
TAUS = 6
ALL = 1e9
"""Periods of a record that is looked at as a whole."""
DELAYS = 8
RIGID = STEMS[:1]
"""He's valve."""
STARTS = 8
"""Cells that go on, of the grid and of what is told."""
FINALISTS = 3


def best_valve(
    whitened: Sequence[Problem], hints: LoopHints, linear: Fit, told: tuple[float, float] | None
) -> Fit | None:
    """Return the most likely sticking valve, its process and its noise; None where none moves.

    Args:
        whitened: The record behind each filter.
        hints: What the engineer knows.
        linear: Best fit without stiction: the search begins with its noise.
        told: S and J of a valve to try as well, OP units.
    """
    rng = np.random.default_rng(0)
    problem = whitened[linear.noise]
    climbed = []
    for structure, candidate in _starts(problem, hints, told):
        fit = fitted(candidate, structure, problem, linear.noise, 30, 0.5)
        if math.isfinite(fit.score):
            climbed.append(_stepped(fit, problem, 0.3, 60, rng))
    climbed.sort(key=lambda fit: -fit.score)
    everywhere = [
        fitted(fit.candidate, fit.structure, each, noise, 40, 0.5)
        for fit in climbed[:FINALISTS]
        for noise, each in enumerate(whitened)
    ]
    if not everywhere:
        return None
    best = max(everywhere, key=lambda fit: fit.score)
    stepped = _stepped(best, whitened[best.noise], 0.2, 150, rng)
    return max(
        stepped,
        fitted(stepped.candidate, stepped.structure, whitened[best.noise], best.noise, 60, 0.3),
        key=lambda fit: fit.score,
    )


def _stepped(fit: Fit, problem: Problem, scale: float, steps: int, rng: np.random.Generator) -> Fit:
    """Let the valve take random steps."""
    error = math.exp(-2 * fit.score / problem.weight.sum()) * problem.weight.sum()
    candidate, error = random_steps(fit.candidate, float(error), scale, fit.structure, problem, steps, rng)
    return Fit(white_likelihood(float(error), problem), fit.noise, fit.structure, candidate)


def _starts(
    problem: Problem, hints: LoopHints, told: tuple[float, float] | None
) -> Iterator[tuple[int, FloatArray]]:
    """Yield the best cells of the grid, and of the levels for the valve that is told."""
    yield from _cells(problem, hints, S_SHARES * problem.op_span, J_RATIOS, LEVEL_STEP)
    if told is not None and told[0] > 0:
        s, j = told
        yield from _cells(problem, hints, np.array([s]), np.array([min(j / s, 1.0)]), FINE_STEP)


def _cells(
    problem: Problem, hints: LoopHints, s_values: FloatArray, j_ratios: FloatArray, level_step: float
) -> Iterator[tuple[int, FloatArray]]:
    taus, ratios = processes(problem, TAUS, np.array([0.0]), integrates=hints.integrating)
    near = bank(problem, taus, ratios, ALL)
    delays = _delays(problem)
    scores, places, levels = scan(
        near, RIGID, s_values, j_ratios, level_step * problem.op_span, problem.period, delays
    )
    allowed = structures(hints)
    for cell in np.argsort(-scores[0], axis=None)[:STARTS]:
        i, j = np.unravel_index(cell, scores[0].shape)
        if scores[0, i, j] <= 0:
            return
        tau, delay = divmod(int(places[0, i, j]), len(delays))
        candidate = np.empty(SIZE)
        set_process(candidate, taus[tau], ratios[tau], delays[delay], problem)
        if problem.fixed_delay > 0:
            candidate[DELAY] = problem.fixed_delay
        set_valve(candidate, near.op, float(s_values[i]), float(j_ratios[j]), levels[0, i, j], RIGID[0])
        integrates = bool(np.isinf(taus[tau]))
        yield (INTEGRATOR if integrates else FOPDT if FOPDT in allowed else allowed[0]), candidate


def _delays(problem: Problem) -> NDArray[np.int64]:
    """Delays of the grid, blocks, ascending."""
    if problem.fixed_delay > 0:
        return np.array([round(to_blocks(problem.fixed_delay, problem.block))])
    longest = max(3.0, 0.5 * problem.max_delay / problem.block)
    return np.unique(np.round(np.geomspace(1, longest, DELAYS)).astype(np.int64))
