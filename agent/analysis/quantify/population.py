"""The joint free-run fit by one population over a growing record, in place of the stages of ``free_run``.

Model, error and answer are those of ``free_run``; the search is ``agent.identify.search``. It takes a part of
the time, at most some seconds. See docs/methods/population.md.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.quantify.free_run import SLIDES_BELOW, answer, unanswered
from agent.analysis.quantify.free_run.problem import pose
from agent.analysis.quantify.free_run.search import Found, structures
from agent.analysis.record.spans import in_spans_of
from agent.identify.fitted import by_error, start
from agent.identify.objective import LEVEL, S
from agent.identify.search.elites import elites_of
from agent.identify.search.linear import best_linear
from agent.identify.search.search import possible_of, search

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agent.analysis.record.recording import LoopWindow
    from agent.analysis.results import Quantification
    from agent.identify.problem import Problem

DIGITS = 9
"""Decimals of a span that are kept: far less than any transmitter resolves, far more than rounding has."""


@dataclass(frozen=True, slots=True)
class PopulationSearch:
    """Joint free-run fit of valve and process by one population."""

    name: str = "population"

    def quantify(self, window: LoopWindow) -> Quantification:
        """Return the better of the sticking and the linear model; failure is a field, never an exception."""
        problem = pose(window)
        if isinstance(problem, str):
            return unanswered(self.name, problem)
        possible = structures(window.hints)
        searched = rounded(window)
        found = None if isinstance(searched, str) else find(searched, problem, possible)
        linear = best_linear(problem, possible, found.best if found else None)
        if linear is None:
            return unanswered(self.name, "no process within bounds follows OP")
        return answer(self.name, found, linear, problem, window)


def rounded(window: LoopWindow) -> Problem | str:
    """Return the problem in spans from the least values, rounded, or in plain words why there is none.

    A search takes another way where last digits differ. So the same record in other units must be the same
    numbers.
    """
    in_spans = in_spans_of(window)
    if in_spans is None:
        return "OP or PV does not move"
    op, pv = np.round(in_spans.op, DIGITS), np.round(in_spans.pv, DIGITS)
    return pose(replace(in_spans, op=op, pv=pv))


def find(searched: Problem, problem: Problem, possible: Sequence[int]) -> Found | None:
    """Return the best model of a sticking valve, and the best at each other S and J; None where none moves.

    Args:
        searched: The record as it is searched, from ``rounded``.
        problem: The record in its units.
        possible: Structures that the process may have.
    """
    without = best_linear(searched, possible)
    worth = math.inf if without is None else without.error / SLIDES_BELOW
    models = elites_of(search(searched, possible, worth), searched, possible_of(possible))
    low = float(problem.op.min())
    fits = []
    for candidate, structure in zip(models.candidates, models.structures, strict=True):
        candidate[S] *= problem.op_span
        candidate[LEVEL] = low + candidate[LEVEL] * problem.op_span
        fits.append(start(candidate, int(structure), problem))
    others = by_error(fits)
    return Found(fits[0], tuple(others), math.inf) if others else None
