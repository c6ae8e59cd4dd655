"""What the innovations say of effects beside each other: which is outdone, which is plain, which is strong.

In free run an effect that is not there may lower the error by more than the one that is, for OP answers to
the load. Innovations know nothing of that, so that they tell causes apart where errors do not.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from agent.workbench.residual.holm import LEVEL
from agent.workbench.residual.very_strong import VERY_STRONG, very_strong

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping

    from agent.workbench.evidence import Evidence


def less_likely(criteria: Mapping[str, float]) -> list[str]:
    """Return the effects with which the record is far less likely than with the best of them.

    ``criteria``: ``Evidence.criterion`` of each.
    """
    best = max(criteria.values(), default=0.0)
    return [name for name, each in criteria.items() if best - each > VERY_STRONG]


def outdone(found: Mapping[str, Evidence]) -> set[str]:
    """Return the effects with which the record is far less likely than with one of another family.

    Also where that one hardly lowers the free-run error. What happened once outdoes nothing: under a load
    that wanders its likelihood is too kind. What knows nothing of OP is not asked.
    """
    able = [each for each in found.values() if each.answers and not each.once and each.more]
    return {
        name
        for name, each in found.items()
        if each.answers
        and any(
            other.criterion - each.criterion > VERY_STRONG for other in able if other.family != each.family
        )
    }


def plain(found: Mapping[str, Evidence]) -> set[str]:
    """Return the effects that the innovations tell beyond chance, and from all others.

    One that acts in a few strokes only leaves the interval of its reduction wide, however plain it is there;
    so does a wave that a load hides in free run.
    """
    return {
        name
        for name, each in found.items()
        if not each.once
        and each.by_chance < LEVEL
        and very_strong(each.criterion, len(found))
        and not any(
            each.criterion - other.criterion <= VERY_STRONG
            for other in found.values()
            if other.family != each.family and (other.answers or other.once)
        )
    }


def is_strong(alike: Collection[Evidence], candidates: int) -> bool:
    """Return whether the best of some effects is very strongly supported, each candidate as likely before.

    What knows nothing of OP need not be: its error in free run tells.
    """
    return any(not each.answers or very_strong(each.criterion, candidates) for each in alike)
