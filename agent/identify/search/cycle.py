"""One cycle of the search in one view of a record: an island, or a climb around what was found.

On an island valves climb: those of a grid at first, later others from anywhere. Around what was found climb
valves scattered about it. The first island is small, because it finds most valves. One criterion: what a
candidate costs (``price``).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from agent.identify.fitted import start
from agent.identify.objective import FOPDT, INTEGRATOR, SIZE, SOPDT
from agent.identify.problem import first_periods
from agent.identify.residuals import autocorrelation
from agent.identify.search.anywhere import valves_from_anywhere
from agent.identify.search.children import scattered
from agent.identify.search.climb import climb
from agent.identify.search.grid import valves_of_grid
from agent.identify.search.population import Candidates, apart, join, least, periods_of, reach

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agent.identify.arrays import IntArray
    from agent.identify.problem import Problem

STRUCTURES = (FOPDT, SOPDT, INTEGRATOR)
MANY_PERIODS = 12
"""Periods from which a record has a first part that distinguishes valves."""
FIRST_SHARE, FIRST_LEAST = 16, 3.0
"""First horizon: periods over ``FIRST_SHARE``, at least ``FIRST_LEAST`` (chosen with ``PARENTS`` and
``ISLAND``);"""
FEW_SHARE, FEW_LEAST = 0.5, 3.5
"""with few periods, half of them."""
FIRST_PARENTS, PARENTS = 200, 1200
"""Parents of the first island and the climb around it, and of all others. Two of three simulated loops need
no more than the first island. Many on few periods find wide bands, whose needles a stem's constants make
narrow (simulated loops, seeds 93500 to 93859 and 94082 to 94441)."""
ISLAND, MORE = 24_000, 600
"""Valves from anywhere on an island, and beside those scattered around what was found."""
SCALE = 0.02
"""How far scattered ones are, OP spans; they are as many as the parents."""
CYCLES_OF_FIRST = 2
"""Cycles with ``FIRST_PARENTS``: the first island and around it."""
GOES_ON = 2
"""Valves from anywhere that climb, over the parents of the first horizon."""
APART = 0.02
"""Distance of those, over the range of a coordinate."""
OF_A_BIN = 64
"""Of one niche, at most: with 16 no more than 800 of them climbed."""
FINALISTS = 24
"""Kept from cycle to cycle."""
WHITE = 0.15
"""Correlation of a residual with the one of the block before up to which it is white: of 122 simulated loops
(seeds 40000 to 40121) every valve whose S was off by more than 2 % of the span left 0.23 or more."""
GAIN = 0.98
"""Cost over that before, above which a cycle gained nothing."""
HOPELESS = 1.24
"""Cost of the best valve over ``worth`` that ends a search after its first island, where nothing is missing:
a hundredth below that of no valve. Of simulated loops (seeds 80000 to 80019) it ends 55 of 60 that do not
stick and one of 120 that do."""
IN_VAIN = 5
"""Cycles in a row without a gain that end a search: around what was found, two islands and around them."""


@dataclass(frozen=True, slots=True)
class Searched:
    """What a search has found so far."""

    finalists: Candidates
    """On the whole record, best first."""
    early: tuple[Candidates, ...] = ()
    """Populations on the way, on parts of the record."""
    ended: str | None = None
    """``white``: the residual is white noise; ``in_vain``: further cycles gained nothing;
    ``explains_little``: hardly better than no valve; None: more might be found."""
    work: float = 0.0
    """Samples through which valves were simulated."""
    cycles: int = 0
    """That were made."""
    vain: int = 0
    """Cycles in a row that gained nothing."""


def nothing() -> Searched:
    """Return what a search has found before its first cycle."""
    return Searched(Candidates(np.empty((0, SIZE)), np.empty(0, dtype=np.int64), np.empty(0)))


def next_cycle(
    before: Searched,
    problem: Problem,
    structures: Sequence[int] = STRUCTURES,
    worth: float = math.inf,
    *,
    around: Candidates | None = None,
    seed: int = 0,
) -> Searched:
    """Return what is found after one more cycle.

    Args:
        before: What the cycles before found.
        problem: The record.
        structures: Processes that are possible, at least one.
        worth: Cost below which a valve explains enough to go on after a large island, PV units squared;
            after the first island ``hopeless`` times that.
        around: What the cycle climbs around; None, or nothing: it is an island.
        seed: Of the random numbers; the same record gives the same answer.
    """
    if around is not None and not len(around.costs):
        around = None  # nothing was found that hints allow
    rng = np.random.default_rng((seed, before.cycles))
    horizon = first_horizon(problem)
    part = first_periods(problem, horizon)
    parents = FIRST_PARENTS if before.cycles < CYCLES_OF_FIRST else PARENTS
    if before.cycles == 0:
        begun = valves_of_grid(problem, structures)
        looked = len(begun.costs)
    else:
        begun, looked = _begun(problem, part, around, parents, structures, rng)
    climbed = climb(begun, problem, horizon, parents, possible_of(structures), rng, around)
    best = join(climbed.population, before.finalists).sorted(FINALISTS)
    vain = before.vain + 1 if least(best) > GAIN * least(before.finalists) else 0
    work = before.work + climbed.work + looked * len(part.op)
    done = Searched(best, before.early + climbed.early, None, work, before.cycles + 1, vain)
    return replace(done, ended=_why_ended(done, problem, worth, settled=around is not None))


def _why_ended(done: Searched, problem: Problem, worth: float, *, settled: bool) -> str | None:
    if least(done.finalists) > (worth if done.cycles > CYCLES_OF_FIRST else hopeless(problem) * worth):
        return "explains_little"
    if settled and periods_of(problem) >= MANY_PERIODS and leaves_white(done.finalists, problem):
        return "white"
    return "in_vain" if done.vain >= IN_VAIN else None


def hopeless(problem: Problem) -> float:
    """Return the cost over ``worth`` that ends a search after its first island; with gaps none does."""
    after_start = problem.weight[int(np.argmax(problem.weight)) :]
    return HOPELESS if after_start.all() else math.inf


def _begun(
    problem: Problem,
    part: Problem,
    around: Candidates | None,
    parents: int,
    structures: Sequence[int],
    rng: np.random.Generator,
) -> tuple[Candidates, int]:
    """Return the valves that a cycle begins with, and how many were looked at for it."""
    count, most = (ISLAND, GOES_ON * parents) if around is None else (MORE, parents)
    begun = valves_from_anywhere(count, problem, part, structures, rng)
    begun = begun.take(apart(begun, most, APART, OF_A_BIN, reach(problem), problem.op_span))
    if around is not None:
        begun = join(begun, scattered(around, parents, SCALE, problem, rng))
    return begun, count


def leaves_white(finalists: Candidates, problem: Problem) -> bool:
    """Whether the residual of the best finalist, the first, has no memory of the block before."""
    structure = int(finalists.structures[0])
    return abs(autocorrelation(start(finalists.candidates[0], structure, problem), problem, 1)) <= WHITE


def possible_of(structures: Sequence[int]) -> IntArray:
    """Return 1 for each structure that is possible, else 0, (3,)."""
    return np.array([int(each in structures) for each in range(len(STRUCTURES))], dtype=np.int64)


def first_horizon(problem: Problem) -> float:
    """Return how many periods the search looks at first."""
    periods = periods_of(problem)
    if periods >= MANY_PERIODS:
        return min(periods, max(FIRST_LEAST, periods / FIRST_SHARE))
    return max(min(FEW_LEAST, periods), FEW_SHARE * periods)
