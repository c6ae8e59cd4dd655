"""Which effects make the record far less likely than others do.

In free run an effect that is not there may lower the error by more than the one that is, for OP answers to
the load. Innovations know nothing of that, so that they distinguish causes where errors do not.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from agent.workbench.residual.very_strong import VERY_STRONG

if TYPE_CHECKING:
    from collections.abc import Mapping

    from agent.workbench.evidence import Evidence


def less_likely(criteria: Mapping[str, float]) -> list[str]:
    """Return the effects with which the record is far less likely than with the best of them.

    ``criteria``: ``Evidence.criterion`` of each.
    """
    best = max(criteria.values(), default=0.0)
    return [name for name, each in criteria.items() if best - each > VERY_STRONG]


def comparable(found: Mapping[str, Evidence]) -> set[str]:
    """Return the effects between which the likelihood decides: those that act on OP, and not once.

    What happened once excludes nothing: under a load that wanders its likelihood is too kind.
    """
    return {name for name, each in found.items() if each.answers and not each.once}


def likelier_otherwise(found: Mapping[str, Evidence]) -> set[str]:
    """Return the effects with which the record is far less likely than with one of another family.

    Also where that one hardly lowers the free-run error. What knows nothing of OP is not excluded.
    """
    able = [found[name] for name in comparable(found) if found[name].explains]
    return {
        name
        for name, each in found.items()
        if each.answers
        and any(
            other.criterion - each.criterion > VERY_STRONG for other in able if other.family != each.family
        )
    }
