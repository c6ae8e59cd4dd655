"""From the coarse candidates to the best model: successive halving, more care for fewer candidates."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.quantify.free_run.coarse_grid import coarse_candidates
from agent.analysis.quantify.free_run.local_search import random_steps, simplex
from agent.analysis.quantify.free_run.objective import (
    DELAY,
    FOPDT,
    INTEGRATOR,
    LAG,
    LOG_TAU,
    LOG_TAU2,
    SIZE,
    SOPDT,
    S,
    free_run_error,
)

if TYPE_CHECKING:
    from agent.analysis.quantify.free_run.problem import Problem
    from agent.analysis.recording import FloatArray, LoopHints

SEARCHED = {FOPDT: (LOG_TAU, DELAY), SOPDT: (LOG_TAU, DELAY, LOG_TAU2), INTEGRATOR: (DELAY,)}
STEP = np.array([0.5, 1.5, 0.5, 0.0, 0.0, 0.0, 0.0, 0.0])
STEMS = ((0.0, 1.0), (0.0, 0.0), (0.1, 0.03))
"""Lag and rest that a search starts from: He's valve, the two-state one, and one between them."""
WORTH_A_PARAMETER = 0.99
"""A second pole or a lagging stem must lower the error to this share, or the simpler model is reported."""


@dataclass(frozen=True, slots=True)
class Fitted:
    """A candidate with its structure and its free-run sum of squares, PV units squared."""

    error: float
    structure: int
    candidate: FloatArray

    @property
    def sticks(self) -> bool:
        """Whether the valve does not simply follow OP."""
        return bool(self.candidate[S] > 0)


def structures(hints: LoopHints) -> tuple[int, ...]:
    """Return the processes that the engineer's knowledge leaves possible."""
    if hints.integrating:
        return (INTEGRATOR,)
    lags = {1: (FOPDT,), 2: (SOPDT,)}.get(hints.order or 0, (FOPDT, SOPDT))
    return lags if hints.integrating is False else (*lags, INTEGRATOR)


def smooth(fitted: Fitted, problem: Problem, scale: float, evaluations: int) -> Fitted:
    """Improve delay and time constants."""
    axes = [a for a in SEARCHED[fitted.structure] if not (a == DELAY and problem.fixed_delay > 0)]
    if not axes:
        return fitted
    candidate, error = simplex(
        fitted.candidate,
        STEP * scale,
        np.array(axes),
        fitted.structure,
        problem,
        evaluations,
    )
    return Fitted(float(error), fitted.structure, candidate)


def refine(fitted: Fitted, problem: Problem, scale: float, smooth_steps: int, steps: int) -> Fitted:
    """Improve the process, then the valve with the process following."""
    fitted = smooth(fitted, problem, scale, smooth_steps)
    candidate, error = random_steps(
        fitted.candidate, fitted.error, scale, fitted.structure, problem, steps, np.random.default_rng(0)
    )
    return Fitted(float(error), fitted.structure, candidate)


def start(candidate: FloatArray, structure: int, problem: Problem) -> Fitted:
    """Evaluate a candidate as it stands."""
    return Fitted(float(free_run_error(candidate, structure, problem)), structure, candidate)


def by_error(fits: list[Fitted]) -> list[Fitted]:
    """Sort, best first."""
    return sorted(fits, key=lambda fitted: fitted.error)


def best_stiction(problem: Problem, hints: LoopHints, per_bin: int = 1) -> Fitted | None:
    """Return the best sticking model, or None where no candidate moves the valve."""
    allowed = structures(hints)
    first = INTEGRATOR if allowed == (INTEGRATOR,) else FOPDT
    promising = []
    for stem in STEMS:
        tried = [start(c, first, problem) for c in coarse_candidates(problem, stem, per_bin)]
        tried = by_error([refine(f, problem, 1.0, 40, 80) for f in tried])
        tried = by_error([refine(f, problem, 1.0, 60, 150) for f in tried[: 20 * per_bin]])
        promising += tried[:3]
    final = []
    for structure in allowed:
        for fitted in promising:
            polished = start(fitted.candidate, structure, problem)
            for _ in range(2):
                polished = refine(polished, problem, 0.7, 100, 250)
            final.append(polished)
    return simplest(final) if final else None


def best_linear(problem: Problem, hints: LoopHints, also: Fitted | None) -> Fitted:
    """Return the best model whose valve follows OP; ``also`` lends its process as one more start."""
    starts = [] if also is None else [also.candidate * np.where(np.arange(SIZE) == S, 0.0, 1.0)]
    delays = [problem.fixed_delay] if problem.fixed_delay > 0 else np.linspace(1, 0.75 * problem.max_delay, 6)
    grid = []
    for log_tau in np.linspace(math.log(0.7), problem.max_log_tau - 1, 8):
        for delay in delays:
            candidate = np.zeros(SIZE)
            candidate[[LOG_TAU, DELAY, LOG_TAU2]] = log_tau, delay, log_tau - 1.6
            grid.append(candidate)
    final = []
    for structure in structures(hints):
        tried = by_error([start(c, structure, problem) for c in grid])[:2]
        tried += [start(c, structure, problem) for c in starts]
        for fitted in tried:
            polished = smooth(fitted, problem, 1.0, 150)
            final.append(smooth(polished, problem, 0.5, 150))
    return simplest(final)


def simplest(fits: list[Fitted]) -> Fitted:
    """Return the least error, but a second pole or a lagging stem only where it buys something."""
    best = by_error(fits)[0]
    enough = [f for f in fits if best.error >= WORTH_A_PARAMETER * f.error]
    return min(enough, key=lambda f: (parameters(f), f.error))


def parameters(fitted: Fitted) -> int:
    """Count what a model has beyond a first-order process and a stem without lag."""
    return int(fitted.structure == SOPDT) + 2 * int(fitted.candidate[LAG] > 0)
