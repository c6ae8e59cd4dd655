"""What the search for a sticking valve found: the likeliest model, and the best at each other S and J."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from agent.analysis.quantify.free_run.problem import FINE, QUICK, SLOW, in_spans, pose, structures
from agent.identify.confidence_set import p_of_models
from agent.identify.fitted import Fitted, by_error, start
from agent.identify.objective import LEVEL, S
from agent.identify.search.cycle import possible_of
from agent.identify.search.elites import FEW_ROUNDS, ROUNDS
from agent.identify.search.likeliest import likeliest_of
from agent.identify.search.linear import best_linear
from agent.identify.search.search import best_in, search
from agent.identify.simplex import polished
from agent.identify.white_view import behind_autoregression

if TYPE_CHECKING:
    from agent.analysis.record.recording import LoopWindow
    from agent.identify.arrays import FloatArray
    from agent.identify.problem import Problem
    from agent.identify.search.search import SearchEnd

SLIDES_BELOW = 1.25
"""Evidence below which a valve is said not to stick; there a search ends after its first large island."""


@dataclass(frozen=True, slots=True)
class Found:
    """Models of a sticking valve."""

    best: Fitted
    """The likeliest; its error is that of the slow view."""
    least_error: Fitted
    """Of it and what the search found, that with the least error in the slow view: verdicts were learnt with
    such valves, and rest on it."""
    others: tuple[Fitted, ...]
    """The best of each cell of S and of J in ``view``, the best among them; the least error first."""
    p: FloatArray
    """Of each of them that it is as good as the best, in that view (``confidence_set``), (k,)."""
    view: Problem
    """The record behind the autoregression of what the best leaves, in its units."""
    ended: SearchEnd
    """Why the search ended."""


def find(window: LoopWindow, problem: Problem) -> Found | None:
    """Return the models of a sticking valve that explain a record best; None where no valve moves.

    Args:
        window: The record.
        problem: What it poses in its units, in the slow view; the search sees it in spans.
    """
    slow, quick, fine = in_spans(window, SLOW), in_spans(window, QUICK), in_spans(window, SLOW, FINE)
    own = pose(window, SLOW, FINE)
    if isinstance(slow, str) or isinstance(quick, str) or isinstance(fine, str) or isinstance(own, str):
        return None
    possible = structures(window.hints)
    without = best_linear(slow, possible)
    worth = math.inf if without is None else without.error / SLIDES_BELOW
    searched = search((slow, quick), possible, worth)
    if not len(searched.searched.finalists.costs):
        return None  # hints allow no valve
    best = best_in(slow, searched.searched)
    rounds = ROUNDS if best.error <= worth else FEW_ROUNDS
    allowed = likeliest_of(searched.searched, best, fine, possible_of(possible), rounds)
    view = own if allowed.noise is None else behind_autoregression(own, allowed.noise)
    models = allowed.models
    fits = [_in_units(*each, view) for each in zip(models.candidates, models.structures, strict=True)]
    if not math.isfinite(fits[0].error):
        return None
    likeliest = polished(fits[0], view)
    others = tuple(by_error([likeliest, *fits[1:]]))
    free_run = start(likeliest.candidate, likeliest.structure, problem)
    ends = (
        polished(each, problem) for each in (_in_units(best.candidate, best.structure, problem), free_run)
    )
    least_error = min(ends, key=lambda each: each.error)
    return Found(free_run, least_error, others, p_of_models(others, view), view, searched.ended)


def _in_units(candidate: FloatArray, structure: int, problem: Problem) -> Fitted:
    """Return a model whose OP is in spans from its least value as a model of a problem in its units."""
    candidate = candidate.copy()
    candidate[S] *= problem.op_span
    candidate[LEVEL] = float(problem.op.min()) + candidate[LEVEL] * problem.op_span
    return start(candidate, int(structure), problem)
