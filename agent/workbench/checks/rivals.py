"""What would be confirmed must be far likelier than rivals that no decision names.

One has no name: linear dynamics that no effect is (``unnamed.py``). Another was not tried: in a bump test OP
turns back once, and a valve that sticks does not come back to where it was, as after a step of the load.
Where too little of that shows, or no such valve is in the library, it may be there all the same.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from agent.workbench.evidence import evidence_of
from agent.workbench.residual.very_strong import VERY_STRONG

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping

    from agent.physics.effect import Effect
    from agent.workbench.evidence import Evidence
    from agent.workbench.hypotheses import Decision
    from agent.workbench.record import Record
    from agent.workbench.step import Step
    from agent.workbench.trial import Optimum


def untried_words(effect: Effect) -> str:
    """Return what an effect that was not tried makes of a decision, in words."""
    return f"{effect.name.replace('_', ' ')}, which was not tried, makes it as likely"


def against_rivals(
    decision: Decision,
    smaller: Step,
    found: Mapping[str, Evidence],
    rivals: Iterable[tuple[Effect, str]],
    together: Callable[[Step | Optimum, Effect], Optimum],
    record: Record,
) -> Decision:
    """Return a decision that would be confirmed as it stands against rivals in the place of its effect.

    Args:
        decision: On what was tried.
        smaller: The model without any effect of ``found``.
        found: What the innovations say of what was tried.
        rivals: Effects, and what to say where one makes the record as likely.
        together: Tries an effect on top of the smaller model.
        record: What all are fitted to.
    """
    own = found[str(decision.effect)]
    if not (own.answers or own.once):
        return decision  # a wave: an autoregression predicts it, so that likelihoods do not compare it
    likeliest = max(found[each].criterion for each in (str(decision.effect), *decision.indistinguishable))
    for effect, words in rivals:
        rival = evidence_of(smaller, together(smaller, effect), record, len(found)).criterion
        if likeliest - rival <= VERY_STRONG:
            decision = replace(decision, kind="suggested", lacks=(*decision.lacks, words))
    return decision
