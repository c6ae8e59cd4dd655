"""All effects that were tried on top of one model, judged together."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cache, partial
from typing import TYPE_CHECKING

from agent.workbench.checks.adequate import adequate
from agent.workbench.checks.lacking import OF_A_LAW, may_be_of_a_law
from agent.workbench.checks.mended import LITTLE, mended_by
from agent.workbench.checks.pairs import far_likelier_than, far_likelier_words, is_beside, likeliest_pair
from agent.workbench.checks.rivals import against_rivals, hidden_words
from agent.workbench.checks.unnamed import AS_LIKELY, LINEAR, dynamics_on
from agent.workbench.checks.wave_lines import SLOW, is_wave, or_slow_wave, wave_objections
from agent.workbench.decision import Decision, judge
from agent.workbench.doubts import ANSWERS, BY_CHANCE, UNLIKELY, Doubts
from agent.workbench.evidence import evidence_of, far_likelier
from agent.workbench.likeliest import comparable, likelier_otherwise
from agent.workbench.residual.holm import LEVEL
from agent.workbench.residual.state_dependence import LEVEL as FOLLOWED
from agent.workbench.residual.state_dependence import fails, state_dependence
from agent.workbench.step import Step, Verdict

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from agent.physics.effect import Effect, Facts
    from agent.workbench.checks.pairs import Pair
    from agent.workbench.evidence import Evidence
    from agent.workbench.fit import Fit
    from agent.workbench.record import Record
    from agent.workbench.residual.line_spectrum import LineSpectrum
    from agent.workbench.residual.where import Failure
    from agent.workbench.trial import Optimum, Tried


WORSE_ELSEWHERE = "with it the model follows the recording for validation less well"


@dataclass(frozen=True, slots=True)
class AllTried:
    """The candidates on top of one model."""

    decision: Decision
    models: Mapping[str, Tried]
    """By the effect that was added."""
    lowered: frozenset[str] = frozenset()
    """Effects that a check makes a suggestion at most, alone or beside another."""

    @property
    def at_bound(self) -> tuple[str, ...]:
        """Parameters of the effect that was decided for which ran into a bound."""
        effect = self.decision.effect
        return () if effect is None else own_at_bound(self.models[effect])


def judged(
    smaller: Step,
    models: Mapping[str, Tried],
    record: Record,
    input_p: Mapping[str, float],
    together: Callable[[Step | Optimum, Effect], Optimum],
    worse: Callable[[Fit, Fit], bool],
    also: Callable[[Optimum], Iterable[Effect]],
    answering: Callable[[Optimum], Iterable[Effect]],
    hidden_rivals: Iterable[Effect],
    screened: int,
) -> AllTried:
    """Judge effects by their held-out errors, and by what the innovations say of each.

    An effect must lower the innovations, as no answer to the disturbance does, and none of another family
    may be far likelier (``likeliest.py``). What acts on OP must be very strongly supported, each candidate as
    likely before, else it is a suggestion; of what knows nothing of OP the error in free run decides.

    Args:
        smaller: The model without any of them.
        models: With each, the simplest of a family first.
        record: What they were fitted to.
        input_p: Of measured inputs: how likely one explains as much where it does not act.
        together: Tries an effect on top of one of the models, or of the smaller one.
        worse: Whether a larger model, the second, follows another recording less well than a smaller one.
        also: What of the library the innovations hint at beside an effect, the best first.
        answering: The same of what acts on OP all the time.
        hidden_rivals: Effects that may be there, but that the record cannot show.
        screened: How many effects were scored, of which ``models`` were fitted: each was a try.
    """

    def beside_dynamics(name: str, other: str) -> bool:
        larger = together(models[name], models[other].fit.model.effects[-1])
        predicts = larger.predicts
        if predicts is None or not far_likelier(models[other], larger, record):
            return False
        return not fails(state_dependence(*predicts))

    tries = max(screened, len(models))
    found = {name: evidence_of(smaller, each, record, tries) for name, each in models.items()}

    @cache
    def pair() -> Pair | None:
        return likeliest_pair(found, models, answering, together, record, tries)

    def beside_pair(name: str, other: Pair) -> bool:
        return is_beside(other, models[name], together, record)

    doubts = Doubts(smaller, models, found, beside_dynamics, beside_pair, pair)
    by_chance = {name: each.by_chance for name, each in found.items()}
    doubts.objections.update(wave_objections(smaller.predicts, models, found))
    answers = SLOW if record.facts.stepped else ANSWERS  # in manual nothing answers PV
    doubts.objections.update(_at_once(found, input_p, answers))
    if smaller.predicts is not None:
        doubts.objections.update(dict.fromkeys(likelier_otherwise(found), UNLIKELY))
    judge_by = partial(
        judge,
        smaller.held_out.losses,
        {name: each.held_out.losses for name, each in models.items()},
        {name: each.family for name, each in found.items()},
        at_bound=[name for name, each in models.items() if own_at_bound(each)],
        by_chance=by_chance,
        input_p=input_p,
        seen={name for name, each in found.items() if not each.blind},
        likelier={name: each.criterion for name, each in found.items() if not is_wave(models[name].fit)},
        comparable=() if smaller.predicts is None else comparable(found),
    )
    decision = or_slow_wave(_or_pair(_undoubted(judge_by, doubts), doubts), found)
    if smaller.predicts is not None and _is_weak(decision, found):
        decision = replace(decision, kind="suggested")
    decision = _lowered(decision, doubts, smaller, models, worse)
    if smaller.predicts is not None and decision.kind in {"confirmed", "family"}:
        rivals = (*_unnamed(decision, smaller), *((each, hidden_words(each)) for each in hidden_rivals))
        decision = against_rivals(decision, smaller, found, rivals, together, record)
    if smaller.predicts is not None and decision.kind in {"confirmed", "family"}:
        decision = adequate(decision, models, found, also, together, record)
    return AllTried(decision, models, frozenset(doubts.lowered))


def _at_once(found: Mapping[str, Evidence], input_p: Mapping[str, float], answers: str) -> dict[str, str]:
    """Return what rejects effects by themselves; waves apart. ``answers``: the words for what acts on OP."""
    objections = {}
    for name, each in found.items():
        if input_p.get(name, 0.0) >= LEVEL or (each.once and not each.explains):
            objections[name] = BY_CHANCE
        elif each.answers and not each.explains:
            objections[name] = answers
    return objections


def _unnamed(decision: Decision, smaller: Step) -> tuple[tuple[Effect, str], ...]:
    """Return linear dynamics without a name as a rival; none of an effect that is a part of them."""
    return () if decision.family in LINEAR else ((dynamics_on(smaller.fit.model.base), AS_LIKELY),)


def _is_weak(decision: Decision, found: Mapping[str, Evidence]) -> bool:
    """Return whether an effect that acts on OP is decided for without very strong support."""
    if decision.effect is None:
        return False
    alike = [found[each] for each in (decision.effect, *decision.indistinguishable)]
    return all(each.answers and not each.plain for each in alike)


def _undoubted(judge_by: Callable[..., Decision], doubts: Doubts) -> Decision:
    """Return the decision that stands after all objections to its effect and its rivals."""
    while True:
        decision = judge_by(objections=doubts.objections)
        effect = decision.effect
        if effect is None:
            return decision
        beyond = decision.kind == "suggested" and not decision.rivals
        if beyond or not doubts.object_to(decision):
            doubted = effect in doubts.objections
            return replace(decision, kind="none", effect=None, family=None) if doubted else decision


def _or_pair(decision: Decision, doubts: Doubts) -> Decision:
    """Return the suggestion of effects that are far likelier than an event, where none stands alone.

    Where each is confirmed beside the other, ``--auto`` adds both, as it does with rivals.
    """
    if decision.kind != "none" or doubts.likelier_pair is None:
        return decision
    first, *others = doubts.likelier_pair.names
    beside = tuple(each for each in others if each in doubts.models)
    family = doubts.found[first].family
    return replace(
        decision, kind="suggested", effect=first, family=family, indistinguishable=beside, rivals=beside
    )


def _lowered(
    decision: Decision,
    doubts: Doubts,
    smaller: Step,
    models: Mapping[str, Tried],
    worse: Callable[[Fit, Fit], bool],
) -> Decision:
    """Return a decision with what it lacks in words, lowered to a suggestion where a check says so."""
    effect = decision.effect
    if effect is None:
        return decision
    words = doubts.lowered.get(effect)
    if (
        words is None
        and not is_wave(models[effect].fit)
        and may_be_of_a_law(doubts.found[effect], smaller.of_laws)
    ):
        words = OF_A_LAW
    if words is None and decision.kind != "suggested" and worse(smaller.fit, models[effect].fit):
        words = WORSE_ELSEWHERE
    pair, together = doubts.likelier_pair, None
    if pair is not None and effect == pair.names[0] and far_likelier_than(pair, doubts.found[effect]):
        together = far_likelier_words(pair)
    lacks = tuple(each for each in (words, together, doubts.lacks.get(effect)) if each is not None)
    lacks = (*decision.lacks, *lacks)
    return replace(decision, kind=decision.kind if words is None else "suggested", lacks=lacks)


def own_at_bound(found: Optimum) -> tuple[str, ...]:
    """Return the parameters of a model's last effect that ran into a bound, where it predicts best.

    There its numbers are those that are reported: in closed loop a free run drifts to bounds, as it answers
    to the load. Of a wave the free run says more, for an autoregression predicts it at any frequency.
    """
    effect, stopped = found.fit.model.effects[-1].name, found.fit.at_bound
    if found.predicts is not None and not is_wave(found.fit):
        predicts, best = found.predicts
        stopped = predicts.space.at_bound(predicts.space.values(best))
    return tuple(name for name in stopped if name.startswith(f"{effect}."))


def verdict_of(
    step: Step, found: AllTried, failures: Sequence[Failure], lines: LineSpectrum | None, facts: Facts
) -> Verdict:
    """Return what a model lacks, as far as its record shows.

    It fails visibly where its residual follows an axis, or holds a wave, wherever that comes from; or where
    its process would be slower than any that the record can show. What would mend that is suggested.
    """
    decision = found.decision
    if decision.kind != "none":
        return Verdict(
            decision.kind,
            decision.effect,
            decision.family,
            decision.indistinguishable,
            found.at_bound,
            decision.lacks,
        )
    follows = any(each.p < FOLLOWED for each in failures)
    waves = lines is not None and lines.certain
    slow = ran_out(step, facts)
    visible = follows or waves or slow
    rejected = {*found.lowered, *(name for name, each in found.models.items() if own_at_bound(each))}
    mends = mended_by(decision.candidates, found.models, step.estimate.dependence, rejected)
    if visible and mends:
        best, *others = mends
        alike = tuple(each.effect for each in others)
        return Verdict("suggested", best.effect, best.family, alike, lacks=(LITTLE,))
    return Verdict("none_of_the_known" if visible else "no_failure_visible", at_bound=slow)


def ran_out(step: Step, facts: Facts) -> tuple[str, ...]:
    """Return the parameters of a linear process that predict best at the upper bound of their search."""
    if not step.fit.model.base.linear:
        return ()
    ends = {each.name: each for each in step.fit.model.base.parameters(facts)}
    return tuple(
        each.name
        for each in step.parameters
        if each.at_bound and each.name in ends and each.value > 0.5 * ends[each.name].high
    )


def naming(verdict: Verdict, name: str) -> Verdict:
    """Return the verdict with ``name`` in front, where it is one of those that cannot be distinguished."""
    if verdict.effect is None or name not in verdict.indistinguishable:
        return verdict
    others = tuple(each for each in (verdict.effect, *verdict.indistinguishable) if each != name)
    return replace(verdict, effect=name, indistinguishable=others)
