"""What one window says of its valve, as one of few outcomes whose rates are known."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Literal, get_args

from agent.analysis.evidence.weighing import MOST, SURE

if TYPE_CHECKING:
    from agent.analysis.diagnosis import Diagnosis
    from agent.analysis.evidence.weighing import Weighed

Outcome = Literal["against", "hardly", "weak", "fair", "strong", "very_strong", "stuck"]
OUTCOMES: tuple[Outcome, ...] = get_args(Outcome)


def logit(probability: float) -> float:
    """Return the log odds of a probability, 0 < p < 1."""
    return math.log(probability / (1 - probability))


EDGES: tuple[tuple[float, Outcome], ...] = (
    (-1.75, "against"),
    (-1.0, "hardly"),
    (0.0, "weak"),
    (logit(SURE), "fair"),
    (0.75 * MOST, "strong"),
)
"""Log odds of a window (``weighing``) below which it has an outcome; beyond the last it is very strong. What
is enough for the verdict stiction is strong, so that no such valve is more probably sound."""

AGAINST: frozenset[Outcome] = frozenset(("against", "hardly", "weak"))
"""Outcomes whose log odds are below zero."""


def outcome_of(diagnosis: Diagnosis) -> Outcome | None:
    """Return the outcome of a window; None where it says nothing of the valve.

    A quiet window, which got no fit, says nothing: how often a loop is quiet depends on its plant, and no
    simulation knows that. A valve that stood while OP travelled far, and then slipped, is ``stuck``: the
    gain that other windows showed makes it more than an accident. Where the cause is not known, and the fit
    is firm that the valve sticks, the valve is the cause, and the fit counts.
    """
    if diagnosis.no_response is not None and diagnosis.verdict != "stiction":
        return "stuck" if diagnosis.no_response.cause == "stuck_valve" else None
    found = diagnosis.quantification
    if diagnosis.weighed is None or found is None or found.failure or found.quick_evidence is None:
        return None  # no fit, one that failed, or of a method whose word has no weight
    return outcome_of_odds(diagnosis.weighed)


def outcome_of_odds(weighed: Weighed) -> Outcome:
    """Return the outcome of a record, or of several that are weighed as one, by its log odds."""
    log_odds = logit(weighed.probability)
    return next((outcome for edge, outcome in EDGES if log_odds < edge), "very_strong")


def part_of(diagnosis: Diagnosis, outcome: Outcome) -> float:
    """Return for which part of a window an outcome counts, 0 to 1.

    One that speaks against stiction counts as far as the window would have shown it. Where OP hardly moves,
    or noise hides what a slip does, a record of any valve shows nothing, and many of them no sound valve.
    """
    found = diagnosis.quantification
    if outcome not in AGAINST or found is None or found.would_show is None:
        return 1.0
    return found.would_show
