"""What a model still lacks with an effect that the record plainly shows: it rejects no such effect.

Where every other cause is far less likely, and what remains is little beside what the effect explains, it is
another effect, or a law that is not quite that of the plant, no sign that the first is not there; where more
remains, it is suggested. Where only the dynamics object, larger dynamics are tried beside it first.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from agent.workbench.checks.remainder import remainder
from agent.workbench.residual.state_dependence import PART_LEFT
from agent.workbench.residual.very_strong import VERY_STRONG

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping

    from agent.workbench.evidence import Evidence
    from agent.workbench.trial import Optimum, Tried

DYNAMICS = frozenset({"op_rate"})
"""Axes on which missing lags and leads show."""
OF_A_LAW = "it is little beside the effects that the model has: their laws are not quite those of the plant"
"""In words, of what ``may_be_of_a_law``."""
LARGER_DYNAMICS = ("second_order", "inverse_response", "integrating")
"""Effects that make the process larger, in the order in which they are tried."""


def is_likeliest_by_far(name: str, found: Mapping[str, Evidence]) -> bool:
    """Return whether an effect that answers to OP makes every one of another family far less likely.

    Args:
        name: Of the effect.
        found: What the innovations say of all candidates.
    """
    own = found[name]
    return (
        own.answers
        and not own.once
        and own.plain
        and all(
            own.criterion - each.criterion > VERY_STRONG
            for each in found.values()
            if each.family != own.family
        )
    )


def is_trifle(name: str, model: Optimum, found: Mapping[str, Evidence]) -> bool:
    """Return whether what remains with the likeliest effect is little beside what it explains.

    Args:
        name: Of the effect.
        model: With it.
        found: What the innovations say of all candidates.
    """
    if model.predicts is None or not is_likeliest_by_far(name, found):
        return False
    return remainder(*model.predicts) <= PART_LEFT * found[name].criterion


def may_be_of_a_law(found: Evidence, of_laws: float) -> bool:
    """Return whether an effect is little beside those that a model has: no law is quite that of the plant.

    What acts on OP may be a part of such a law, and an event may stand for one. A load that goes on and knows
    nothing of OP, measured or a wave, is no part of it.

    Args:
        found: What the innovations say of the effect.
        of_laws: How much likelier the record is with what acts on OP in the model, ``Step.of_laws``.
    """
    bears_on_op = found.answers or found.once
    return bears_on_op and of_laws > 0.0 and found.criterion <= PART_LEFT * of_laws


def larger_dynamics(models: Mapping[str, Tried], beside: Collection[str]) -> tuple[str, ...]:
    """Return the effects that make the dynamics larger, of other families than those ``beside`` them."""
    return tuple(name for name in LARGER_DYNAMICS if name in models and name not in beside)


def lacks_words(axes: Collection[str]) -> str:
    """Return what a model lacks, in words, by the axes on which it still fails."""
    return f"with it the model still fails with {', '.join(sorted(each.replace('_', ' ') for each in axes))}"
