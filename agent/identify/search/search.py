"""One search in two views of a record, in turn: behind a slow and behind a quick high-pass filter.

Behind the slow filter white noise is white, and behind the quick one a load that wanders: a high-pass
filter of the first order is the innovations form of an integrated moving average. A valve that is a needle in
one view is often found at once in the other. Each view has islands of its own, so that two that find the same
valve are two independent trials; where they differ, each climbs around what the other found, too.
See docs/methods/free_run.md.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from agent.identify.fitted import Fitted, start
from agent.identify.objective import J_RATIO, S
from agent.identify.search.cycle import FINALISTS, STRUCTURES, Searched, next_cycle, nothing
from agent.identify.search.population import counted_blocks, join, least, taken_over
from agent.identify.simplex import polished

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agent.identify.problem import Problem

TURNS = (0, 1, 1, 0, 0, 1, 0, 1)
"""Views that have an island, and climb around what it found, in turn: the small islands of both, then the
large one of the quick view first, which finds more (simulated loops, seeds 47000 to 47059)."""
OWN = 3
"""First turns in which a view sees nothing of what the other found."""
SAME_S, SAME_J = 0.01, 0.1
"""Differences of S and J, OP spans, up to which both views found the same valve. S is what noise moves it by;
J is weakly determined in many records, but where it differs by more they are different valves."""
LIKELIER = 10.0
"""Difference of -2 log likelihood from which the quick view decides: very strong evidence (Kass and Raftery,
JASA 90 (1995) 773)."""
BUDGET = 120e6
"""Samples through which valves may be simulated before the last turn: about a second of one core."""
SearchEnd = Literal["white", "agreed", "explains_little", "spent"]
"""Why a search ended. ``white``: the residual is white noise; ``agreed``: both views found the same valve;
``explains_little``: hardly better than no valve; ``spent``: budget or turns are, and more might be found."""


@dataclass(frozen=True, slots=True)
class SearchedViews:
    """What a search in views found."""

    view: int
    """The view whose model is likelier."""
    searched: Searched
    """In that view."""
    ended: SearchEnd
    work: float
    """Samples through which valves were simulated, in all views."""


def search(
    views: Sequence[Problem], structures: Sequence[int] = STRUCTURES, worth: float = math.inf, seed: int = 0
) -> SearchedViews:
    """Return the best valves with their processes.

    Args:
        views: The same record behind the slow and behind the quick filter.
        structures: Processes that are possible, at least one.
        worth: Cost in the first view below which a valve explains enough to go on, PV units squared.
        seed: Of the random numbers; the same record gives the same answer.
    """
    found = [nothing(), nothing()]
    limits = (worth, math.inf)

    def go_on(view: int, *, around: bool, guests: bool = False) -> None:
        seen = found[view].finalists
        if guests:
            seen = join(seen, taken_over(found[1 - view].finalists, views[view])).sorted(FINALISTS)
        found[view] = next_cycle(
            found[view], views[view], structures, limits[view], around=seen if around else None, seed=seed
        )

    ended: SearchEnd | None = None
    for turn, view in enumerate(TURNS):
        if found[view].ended or (view and least(found[0].finalists) > worth):
            continue
        go_on(view, around=False)
        if not found[view].ended:
            go_on(view, around=True, guests=turn >= OWN)
        ended = _end(found, view, views, own=turn < OWN)
        if ended or sum(each.work for each in found) > BUDGET:
            break
    view = likelier(found, views)
    if view:  # in the slow view the same valve may show more of its jump
        go_on(0, around=True, guests=True)
        view = likelier(found, views)
    return SearchedViews(view, found[view], ended or "spent", sum(each.work for each in found))


def _end(found: Sequence[Searched], view: int, views: Sequence[Problem], *, own: bool) -> SearchEnd | None:
    """Return why the search ends after a turn of a view; None: it goes on."""
    if found[view].ended == "explains_little":
        return "explains_little"
    if found[view].ended == "white" and view == likelier(found, views):
        return "white"
    return "agreed" if own and _agree(found, views) else None


def likelier(found: Sequence[Searched], views: Sequence[Problem]) -> int:
    """Return the view whose best model is likelier; the first where the second is not by far."""
    if not found[1].cycles:
        return 0
    slow, quick = (min(surprise(each, view) for view in views) for each in found)
    return int(slow - quick > LIKELIER)


def surprise(searched: Searched, view: Problem) -> float:
    """Return -2 log likelihood of the best model in a view, without what all models of a record share.

    Its process is fitted again. The filter passes ``keep`` times the innovations of what it whitens.
    """
    count = counted_blocks(view)
    return count * math.log(max(best_in(view, searched).error, 1e-300) / count / view.keep**2)


def best_in(view: Problem, searched: Searched) -> Fitted:
    """Return the best model with its process fitted to a view of the record, maybe another."""
    best = searched.finalists
    return polished(start(best.candidates[0].copy(), int(best.structures[0]), view), view)


def _agree(found: Sequence[Searched], views: Sequence[Problem]) -> bool:
    """Whether both views found the same valve."""
    if not all(each.cycles for each in found):
        return False
    one, other = (each.finalists.candidates[0] for each in found)
    span = views[0].op_span
    j = abs(one[S] * one[J_RATIO] - other[S] * other[J_RATIO])
    return bool(abs(one[S] - other[S]) <= SAME_S * span and j <= SAME_J * span)
