"""An explanation must leave a residual that is as good as noise, or be confirmed together with what remains.

What remains with an effect (``remainder.py``) may be another effect of the library, one that the innovations
hint at or that is likely by itself: then both are needed, and nothing remains with both. Else the true cause
may be one that is not in the library, which the effect stands for: it is suggested, unless what remains is a
trifle beside what it explains, and no other family explains nearly as much: no law is quite that of the
plant. One price for all effects, whether they act on OP, happened once, or go on all the time.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from agent.physics.effects.sinusoid import Sinusoid
from agent.workbench.checks.lacking import is_trifle
from agent.workbench.checks.remainder import remainder
from agent.workbench.evidence import far_likelier
from agent.workbench.library import happens_once
from agent.workbench.residual.very_strong import VERY_STRONG

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping

    from agent.physics.effect import Effect
    from agent.workbench.evidence import Evidence
    from agent.workbench.hypotheses import Decision
    from agent.workbench.record import Record
    from agent.workbench.step import Step
    from agent.workbench.trial import Optimum, Tried

NOT_IN_LIBRARY = "with it something remains that no effect of the library explains"


MOST_BESIDE = 2
"""Effects of the library that are tried beside it, one after the other: more in one loop are seldom."""


def adequate(
    decision: Decision,
    models: Mapping[str, Tried],
    found: Mapping[str, Evidence],
    also: Callable[[Optimum], Iterable[Effect]],
    together: Callable[[Step | Optimum, Effect], Optimum],
    record: Record,
) -> Decision:
    """Return a decision that would be confirmed as it stands by what remains with its effect.

    Args:
        decision: On ``models``.
        models: By the effect that was added.
        found: What the innovations say of each.
        also: What of the library the innovations hint at beside the last effect of a model, the best first.
        together: Tries an effect on top of one of the models.
        record: What they were fitted to.
    """
    name = str(decision.effect)
    model: Optimum = models[name]
    once = happens_once(model.fit.model.effects[-1], record.facts)
    added: list[str] = []
    while not _is_noise(model):
        beside = (*_likely_alone(model, models, found), *also(model)) if len(added) < MOST_BESIDE else ()
        larger = _larger(model, models, beside, together, record)
        if larger is None:
            # The law of a balance is a guess: what remains may be its own, or an event may stand for it.
            guessed = not once and not model.fit.model.base.linear
            kind = decision.kind if guessed or is_trifle(name, models[name], found) else "suggested"
            return replace(decision, kind=kind, lacks=(*decision.lacks, NOT_IN_LIBRARY))
        model = larger
        added.append(model.fit.model.effects[-1].name.replace("_", " "))
    if not added:
        return decision
    return replace(decision, lacks=(*decision.lacks, f"with it {' and '.join(added)} is still missing"))


def _larger(
    model: Optimum,
    models: Mapping[str, Tried],
    beside: Iterable[Effect],
    together: Callable[[Step | Optimum, Effect], Optimum],
    record: Record,
) -> Optimum | None:
    """Return a model with one more effect that is needed beside the others; None: there is none."""
    # A wave is seen by itself: an autoregression predicts it, so that it may make nothing likelier.
    seen = any(isinstance(each, Sinusoid) for each in model.fit.model.effects)
    for other in beside:
        larger = together(model, other)
        alone = [models[other.name]] if other.name in models and not seen else []
        if all(far_likelier(each, larger, record) for each in (model, *alone)):
            return larger
    return None


def _likely_alone(model: Optimum, models: Mapping[str, Tried], found: Mapping[str, Evidence]) -> list[Effect]:
    """Return the likeliest effect, if any, that is very strongly supported and of a family not in a model.

    Without a wave that is missing too, its free run may make more error than none.
    """
    families = {each.family for each in model.fit.model.effects}
    able = [name for name, each in found.items() if each.plain and each.family not in families]
    return [models[max(able, key=lambda name: found[name].criterion)].fit.model.effects[-1]] if able else []


def _is_noise(found: Optimum) -> bool:
    """Return whether nothing remains with a model that is very strongly supported; not known is yes."""
    return found.predicts is None or remainder(*found.predicts) <= VERY_STRONG
