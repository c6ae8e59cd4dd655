"""From the coarse candidates to the best model and those beside it: a longer record for fewer candidates.

One slip missed displaces the stem until the next reversal or longer, so that the basin of the true valve
narrows with every stroke: over the whole record it is a needle a quarter per cent wide, over four periods
some per cent. Candidates are therefore fitted to the first periods and follow the basin as the record
grows, and those that lose it are dropped. The best of each bin of S, of each half of J/S and of each kind of
stem is fitted to the whole record as well, so that the search yields the error against S on its way.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from agent.analysis.quantify.free_run.coarse_grid import COARSE, Family
from agent.analysis.quantify.free_run.fitted import evaluated, refine, restart, smooth
from agent.analysis.quantify.free_run.shooting_search import STAGES, shot
from agent.analysis.quantify.free_run.starts import best_by_bin, climbed
from agent.identify.fitted import Fitted, by_error, start
from agent.identify.objective import (
    DELAY,
    FIRST,
    FOPDT,
    INTEGRATOR,
    J_RATIO,
    LEVEL,
    SIZE,
    SOPDT,
    S,
)
from agent.identify.problem import FIRST_LOOK, first_periods
from agent.identify.search.linear import process_grid

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agent.analysis.record.recording import LoopHints
    from agent.identify.problem import Problem

TO_A_BIN = 5
"""Candidates of a bin that the first horizon sees."""


class Horizon(NamedTuple):
    """One length of record, and what is spent on it."""

    periods: float
    """Infinite: the whole record."""
    scale: float
    """Of the random steps."""
    evaluations: tuple[int, int]
    """For the process, and for the valve with the process following."""
    kept: int
    """Candidates that see the next horizon, at most three of a bin."""


HORIZONS = (
    Horizon(FIRST_LOOK, 0.5, (20, 50), 160),
    Horizon(8, 0.4, (30, 60), 50),
    Horizon(12, 0.3, (30, 60), 20),
    Horizon(20, 0.2, (30, 80), 12),
    Horizon(40, 0.2, (30, 80), 8),
    Horizon(math.inf, 0.15, (30, 80), 6),
)
OF_ONE_BIN = 3
SPREAD_FROM = 8
"""Horizon (periods) whose best of each bin go to the whole record, for the intervals."""
SHOT = 40
"""Candidates of the first horizon that the search by shots starts from."""
FINALISTS = 2
SURER = 0.8
"""Error of shots over that of the best free run below which the shots decide."""
OFFSETS = (0.0025, 0.005, 0.01, 0.02, 0.04)
"""Distances from the best S, OP spans, at which all else is fitted again; three times that in J."""
WORTH_A_PARAMETER = 0.99
"""A second pole must lower the error to this share, or the simpler model is reported."""


@dataclass(frozen=True, slots=True)
class Found:
    """What the search for a sticking valve found."""

    best: Fitted
    others: tuple[Fitted, ...]
    """The best model of each bin of S and J, and those close to the best one; the least error first."""
    by_shots: float = math.inf
    """Error of the best by shots, with what the set-off stems cost, PV units squared."""

    @property
    def least(self) -> Fitted:
        """The free run that fits best, which the shots may have decided against."""
        return min((self.best, *self.others[:1]), key=lambda fitted: fitted.error)

    @property
    def least_error(self) -> float:
        """Its sum of squares, PV units squared."""
        return self.least.error

    @property
    def by_shots_alone(self) -> bool:
        """Whether the shots decide: the free run of the best goes wrong at a stroke or two."""
        return self.by_shots < SURER * self.best.error


def structures(hints: LoopHints) -> tuple[int, ...]:
    """Return the processes that the engineer's knowledge leaves possible."""
    if hints.integrating:
        return (INTEGRATOR,)
    lags = {1: (FOPDT,), 2: (SOPDT,)}.get(hints.order or 0, (FOPDT, SOPDT))
    return lags if hints.integrating is False else (*lags, INTEGRATOR)


def best_stiction(problem: Problem, hints: LoopHints) -> Found | None:
    """Return the best sticking model and its neighbours, or None where no candidate moves the valve."""
    rng = np.random.default_rng(0)
    climbs = climbed(problem, Family(hints.integrating), COARSE, rng)
    starts = best_by_bin(climbs, problem, TO_A_BIN)
    followed, spread, early = follow(starts, problem, rng)
    if not followed:
        return None
    surest, free = shot(early[:SHOT], followed[0], STAGES, problem, rng)
    followed += [start(each.candidate, each.structure, problem) for each in free]
    return concluded(followed, surest, spread, problem, hints, rng)


def concluded(
    followed: Sequence[Fitted],
    surest: Fitted | None,
    spread: Sequence[Fitted],
    problem: Problem,
    hints: LoopHints,
    rng: np.random.Generator,
) -> Found | None:
    """Return what a search found: the best of ``followed``, or the ``surest`` by shots where that decides."""
    finalists = by_error(refine(followed, problem, 0.1, (80, 250), rng))[:FINALISTS]
    final = list(finalists)
    for fitted in finalists:
        for structure in structures(hints):
            again = refine([restart(fitted, structure)], problem, 0.2, (80, 200), rng)
            final += refine(again, problem, 0.1, (80, 250), rng)
    allowed = [f for f in by_error(final) if f.structure in structures(hints)]
    if not allowed:
        return None
    (best,) = refine([simplest(allowed)], problem, 0.03, (100, 300), rng)
    if surest is not None and surest.error < SURER * best.error and surest.structure in structures(hints):
        best = start(surest.candidate, surest.structure, problem)
    others = by_error([*spread, *followed, *final, *around(best, problem, rng)])
    return Found(best, tuple(others), surest.error if surest else math.inf)


def surer(
    found: Found,
    surest: Fitted | None,
    free: Sequence[Fitted],
    problem: Problem,
    hints: LoopHints,
    rng: np.random.Generator,
) -> Found:
    """Return what a further search found, or what was found before where that needs no more by shots.

    ``surest`` is the best by shots, ``free`` those that may fit the free run.
    """
    if surest is None or surest.error >= found.by_shots:
        return found
    followed = [found.best, *(start(each.candidate, each.structure, problem) for each in free)]
    return concluded(followed, surest, found.others, problem, hints, rng) or found


def led_by(best: Fitted, found: Found, problem: Problem, rng: np.random.Generator) -> Found:
    """Return what was found with another best model, and what is around that."""
    others = by_error([best, *found.others, *around(best, problem, rng)])
    return Found(best, tuple(others), found.by_shots)


def follow(
    starts: Sequence[Fitted], problem: Problem, rng: np.random.Generator
) -> tuple[list[Fitted], list[Fitted], list[Fitted]]:
    """Return the candidates that follow the growing record to its end, and the best of each bin there.

    And those of the first horizon, for the search by shots.
    """
    spread: list[Fitted] = []
    early: list[Fitted] = []
    for horizon in HORIZONS:
        part = first_periods(problem, horizon.periods)
        begun = [restart(each, each.structure) for each in starts]
        fitted = refine(begun, part, horizon.scale, horizon.evaluations, rng)
        early = early or best_by_bin(fitted, problem)
        if horizon.periods == SPREAD_FROM:
            spread = [restart(f, f.structure) for f in best_by_bin(fitted, problem)]
        starts = best_by_bin(fitted, problem, OF_ONE_BIN)[: horizon.kept]
        if len(part.pv) == len(problem.pv):
            break
    return list(starts), refine(spread, problem, 0.2, (30, 40), rng), early


def around(best: Fitted, problem: Problem, rng: np.random.Generator) -> list[Fitted]:
    """Start again a little off the best S, and J, so that the neighbourhood of the best is seen."""
    fits = []
    for off in np.outer(OFFSETS, (-problem.op_span, problem.op_span)).ravel():
        for axis in (S, J_RATIO):
            candidate = best.candidate.copy()
            s, j = candidate[S], candidate[S] * candidate[J_RATIO]
            if axis == S:
                s += off
                candidate[LEVEL] += 0.5 * candidate[FIRST] * off
                if problem.fixed_delay == 0:
                    candidate[DELAY] = max(1.0, candidate[DELAY] - 0.5 * off / problem.op_speed)
            else:
                j += 3 * off
            if not 0 < s <= problem.op_span:
                continue
            candidate[S], candidate[J_RATIO] = s, min(max(j / s, 0.0), 1.0)
            fits.append(Fitted(math.inf, best.structure, candidate))
    return refine(fits, problem, 0.05, (30, 40), rng)


def best_linear(problem: Problem, hints: LoopHints, also: Fitted | None) -> Fitted | None:
    """Return the best model whose valve follows OP; ``also`` lends its process as one more start."""
    starts = [] if also is None else [also.candidate * np.where(np.arange(SIZE) == S, 0.0, 1.0)]
    grid = process_grid(problem, -1.6)
    final = []
    for structure in structures(hints):
        tried = by_error(evaluated(grid, structure, problem))[:2] + evaluated(starts, structure, problem)
        for fitted in tried:
            polished = smooth(fitted, problem, 1.0, 150)
            final.append(smooth(polished, problem, 0.5, 150))
    final = by_error(final)
    return simplest(final) if final else None


def simplest(fits: Sequence[Fitted]) -> Fitted:
    """Return the least error, but a second pole only where it buys something; ``fits`` are not empty."""
    best = by_error(fits)[0]
    enough = [f for f in fits if WORTH_A_PARAMETER * f.error <= best.error]
    return min(enough, key=lambda f: (f.structure == SOPDT, f.error))
