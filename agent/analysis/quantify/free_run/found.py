"""What the search for a sticking valve found: the best model, and the best at each other S and J."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from agent.analysis.quantify.free_run.problem import QUICK, SLOW, in_spans, pose, structures
from agent.identify.confidence_set import p_of_models
from agent.identify.fitted import Fitted, by_error, start
from agent.identify.objective import LEVEL, S
from agent.identify.search.cycle import possible_of
from agent.identify.search.elites import FEW_ROUNDS, ROUNDS, elites_of
from agent.identify.search.linear import best_linear
from agent.identify.search.search import best_in, search
from agent.identify.simplex import polished

if TYPE_CHECKING:
    from agent.analysis.record.recording import LoopWindow
    from agent.identify.arrays import FloatArray
    from agent.identify.problem import Problem
    from agent.identify.search.population import Candidates
    from agent.identify.search.search import SearchEnd

SLIDES_BELOW = 1.25
"""Evidence below which a valve is said not to stick; there a search ends after its first large island."""


@dataclass(frozen=True, slots=True)
class Found:
    """Models of a sticking valve."""

    best: Fitted
    """The least cost: error in the slow view, and price of what it has more than the simplest."""
    others: tuple[Fitted, ...]
    """The best of each cell of S and of J, the best among them; the least error first. Their errors are in
    the view in which they were found."""
    p: FloatArray
    """Of each of them that it is as good as the best, in that view (``confidence_set``), (k,)."""
    least_error: float
    """The least sum of squares in the slow view, PV units squared."""
    ended: SearchEnd
    """Why the search ended."""


def find(window: LoopWindow, problem: Problem) -> Found | None:
    """Return the models of a sticking valve that explain a record best; None where no valve moves.

    Args:
        window: The record.
        problem: What it poses in its units, in the slow view; the search sees it in spans.
    """
    slow, quick = in_spans(window, SLOW), in_spans(window, QUICK)
    if isinstance(slow, str) or isinstance(quick, str):
        return None
    possible = structures(window.hints)
    without = best_linear(slow, possible)
    worth = math.inf if without is None else without.error / SLIDES_BELOW
    searched = search((slow, quick), possible, worth)
    if not len(searched.searched.finalists.costs):
        return None  # hints allow no valve
    rounds = ROUNDS if best_in(slow, searched.searched).error <= worth else FEW_ROUNDS
    models = elites_of(searched.searched, (slow, quick)[searched.view], possible_of(possible), rounds)
    own = pose(window, pass_time=QUICK) if searched.view else problem
    if isinstance(own, str):
        return None
    fits = _in_units(models, own)
    if not math.isfinite(fits[0].error):
        return None
    best = polished(fits[0], own)
    others = tuple(by_error([best, *fits[1:]]))
    least = others[0].error
    if searched.view:
        best = polished(start(best.candidate, best.structure, problem), problem)
        least = best.error
    return Found(best, others, p_of_models(others, own), least, searched.ended)


def _in_units(models: Candidates, problem: Problem) -> list[Fitted]:
    """Return models whose OP is in spans from its least value as models of a problem in its units."""
    low = float(problem.op.min())
    fits = []
    for candidate, structure in zip(models.candidates, models.structures, strict=True):
        candidate[S] *= problem.op_span
        candidate[LEVEL] = low + candidate[LEVEL] * problem.op_span
        fits.append(start(candidate, int(structure), problem))
    return fits
