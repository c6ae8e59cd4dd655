"""What the search for a sticking valve found: the best model, and the best at each other S and J."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from agent.analysis.quantify.free_run.problem import in_spans, structures
from agent.identify.fitted import Fitted, by_error, start
from agent.identify.objective import LEVEL, S
from agent.identify.problem import PASS_TIME
from agent.identify.search.elites import elites_of
from agent.identify.search.linear import best_linear
from agent.identify.search.search import possible_of, search
from agent.identify.simplex import polished

if TYPE_CHECKING:
    from agent.analysis.record.recording import LoopWindow
    from agent.identify.problem import Problem

SLIDES_BELOW = 1.25
"""Evidence below which a valve is said not to stick; there a search ends after its first large island."""


@dataclass(frozen=True, slots=True)
class Found:
    """Models of a sticking valve."""

    best: Fitted
    """The least cost: error, and price of what it has more than the simplest."""
    others: tuple[Fitted, ...]
    """The best of each cell of S and of J, the best among them; the least error first."""

    @property
    def least_error(self) -> float:
        """The least sum of squares, PV units squared."""
        return min(self.best.error, self.others[0].error)


def find(window: LoopWindow, problem: Problem, pass_time: float = PASS_TIME) -> Found | None:
    """Return the models of a sticking valve that explain a record best; None where no valve moves.

    Args:
        window: The record.
        problem: What it poses, in its units; the search sees it in spans.
        pass_time: Time constant of the high-pass filter of ``problem``, periods.
    """
    searched = in_spans(window, pass_time)
    if isinstance(searched, str):
        return None
    possible = structures(window.hints)
    without = best_linear(searched, possible)
    worth = math.inf if without is None else without.error / SLIDES_BELOW
    models = elites_of(search(searched, possible, worth), searched, possible_of(possible))
    low = float(problem.op.min())
    fits = []
    for candidate, structure in zip(models.candidates, models.structures, strict=True):
        candidate[S] *= problem.op_span
        candidate[LEVEL] = low + candidate[LEVEL] * problem.op_span
        fits.append(start(candidate, int(structure), problem))
    if not math.isfinite(fits[0].error):
        return None
    best = polished(fits[0], problem)
    return Found(best, tuple(by_error([best, *fits[1:]])))
