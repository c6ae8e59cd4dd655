"""What the innovations say of an effect: more than OP knows of the disturbance, and how likely by chance."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from agent.workbench.fit import SCAN, residual_of
from agent.workbench.innovations import by_chance, innovations, likelihood_ratio, tells_more
from agent.workbench.library import acts_on_op, happens_once
from agent.workbench.prediction_error import least_innovations

if TYPE_CHECKING:
    from collections.abc import Mapping

    from agent.workbench.fit import Fit
    from agent.workbench.record import Record

VERY_STRONG = 10.0
"""Evidence for one of two models, twice a logarithm (Kass and Raftery, J. Am. Stat. Assoc. 90 (1995) 773)."""


@dataclass(frozen=True, slots=True)
class Evidence:
    """What the innovations say of an effect."""

    more: bool
    """Whether it explains more than what OP knows of the disturbance."""
    by_chance: float
    """How likely they fall as far where nothing is missing."""
    criterion: float = 0.0
    """How much likelier the record is with it: Schwarz's criterion, twice a logarithm."""


def evidence_of(smaller: Fit, larger: Fit, record: Record, candidates: int) -> Evidence:
    """Return what the innovations say of the last effect.

    A disturbance of its own time knows nothing of OP, so it need only be no worse.
    """
    effect = larger.model.effects[-1]
    answers = acts_on_op(effect, record.facts)
    base = smaller.model.base
    raw = [innovations(residual_of(each, record)) for each in (smaller, larger)]
    least = raw
    if base.linear:
        count = len(base.parameters(record.facts))
        starts = [each.values[:count] for each in (smaller, larger)]
        least = [least_innovations(each, record, starts) for each in (smaller, larger)]
    before, after = least if answers else raw
    if before is None or after is None or least[0] is None or least[1] is None:
        return Evidence(more=True, by_chance=1.0)
    searched = len(larger.values) - len(smaller.values)
    solved = len(larger.coefficients) - len(smaller.coefficients)
    count = int(np.count_nonzero(np.isfinite(least[0].values)))
    likelier = likelihood_ratio(least[0], least[1]) - (searched + solved) * math.log(count)
    chance = 1.0
    if base.linear and (answers or happens_once(effect, record.facts)):
        # What goes on all the time, as a wave does, is in every block: there their signs tell.
        # Each instant is searched over the whole record.
        instants = sum(each.instant for each in effect.parameters(record.facts))
        tries = candidates * SCAN ** max(1, instants)
        chance = by_chance(least[0], least[1], searched + solved, tries)
    return Evidence(tells_more(before, after, searched if answers else 0), chance, likelier)


def less_likely(rivals: Mapping[str, Evidence]) -> list[str]:
    """Return those with which the record is far less likely than with the best of them."""
    best = max(each.criterion for each in rivals.values())
    return [name for name, each in rivals.items() if best - each.criterion > VERY_STRONG]
