"""A cause that the record cannot show may still be the one: what is confirmed must be far likelier.

In a bump test OP turns back once, and a valve that sticks does not come back to where it was. That is no
proof of stiction, for a step of the load does the same; so it is none of a step of the load either.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from agent.workbench.evidence import evidence_of
from agent.workbench.residual.very_strong import VERY_STRONG

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping

    from agent.physics.effect import Effect
    from agent.workbench.decision import Decision
    from agent.workbench.evidence import Evidence
    from agent.workbench.record import Record
    from agent.workbench.step import Step
    from agent.workbench.trial import Optimum


def against_hidden_rivals(
    decision: Decision,
    smaller: Step,
    found: Mapping[str, Evidence],
    hidden_rivals: Iterable[Effect],
    together: Callable[[Step | Optimum, Effect], Optimum],
    record: Record,
) -> Decision:
    """Return a decision that would be confirmed as it stands against effects that the record cannot show.

    Args:
        decision: On what was tried.
        smaller: The model without any effect of ``found``.
        found: What the innovations say of what was tried.
        hidden_rivals: Effects that move PV and that the record cannot show.
        together: Tries an effect on top of the smaller model.
        record: What all are fitted to.
    """
    own = found[str(decision.effect)]
    if not (own.answers or own.once):
        return decision  # a wave: an autoregression predicts it, so that likelihoods do not compare it
    alike = (str(decision.effect), *decision.indistinguishable)
    likeliest = max(found[each].criterion for each in alike)
    for effect in hidden_rivals:
        rival = evidence_of(smaller, together(smaller, effect), record, len(found)).criterion
        if likeliest - rival <= VERY_STRONG:
            words = f"{effect.name.replace('_', ' ')}, which this record cannot show, makes it as likely"
            return replace(decision, kind="suggested", lacks=(*decision.lacks, words))
    return decision
