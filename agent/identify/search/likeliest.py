"""The likeliest models of a record, and what else it allows: elites behind the autoregression of the best.

The search follows valves in views whose noise is one of two: white, or a walk. The last per cent of S and
most of J depend on what the noise is, and that is known with the best valve only. So the elites live in a
view that is made of it: at a fine rate, for the instants of slips count, and behind the autoregression of
what the best valve leaves. A better one leaves another, behind which they live on.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from agent.identify.search.elites import ROUNDS, elites_of, met_by
from agent.identify.white_view import behind_autoregression, noise_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agent.identify.arrays import IntArray
    from agent.identify.fitted import Fitted
    from agent.identify.noise.autoregression import Innovations
    from agent.identify.problem import Problem
    from agent.identify.search.cycle import Searched
    from agent.identify.search.population import Candidates

FIRST_ROUNDS = ROUNDS[4::4]
"""Behind the autoregression of what the search found, which has learnt a part of what that valve misses."""


class Likeliest(NamedTuple):
    """What a record allows."""

    models: Candidates
    """The best of each cell of S and of J, the likeliest first."""
    noise: Innovations | None
    """Of what the best leaves; None where too few samples in a row are known."""


def likeliest_of(
    searched: Searched,
    best: Fitted,
    problem: Problem,
    possible: IntArray,
    rounds: Sequence[float] = ROUNDS,
) -> Likeliest:
    """Return the likeliest models.

    Args:
        searched: What a search found.
        best: Of that, the best in the view of ``problem``.
        problem: The record in fine blocks.
        possible: 1 for each structure that is possible, (3,).
        rounds: Largest step of each round of children, OP spans.
    """
    models, found = met_by(searched, problem), None
    candidate, structure = best.candidate, best.structure
    for steps in (FIRST_ROUNDS, rounds):
        noise = noise_of(candidate, structure, problem)
        if noise is None:
            break
        found = noise
        models = elites_of(models, behind_autoregression(problem, noise), possible, steps)
        candidate, structure = models.candidates[0], int(models.structures[0])
    if found is None:
        models = elites_of(models, problem, possible, rounds)
    return Likeliest(models, found)
