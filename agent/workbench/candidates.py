"""All effects that were tried on top of one model, judged together."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from agent.workbench.decision import LEAST_PERCENT, LEVEL, Decision, judge
from agent.workbench.evidence import evidence_of, less_likely
from agent.workbench.library import acts_on_op, happens_once
from agent.workbench.state_dependence import LEVEL as FOLLOWED
from agent.workbench.state_dependence import resolves, state_dependence
from agent.workbench.step import Step, Verdict

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agent.workbench.fit import Fit
    from agent.workbench.line_spectrum import LineSpectrum
    from agent.workbench.record import Record
    from agent.workbench.trial import Tried
    from agent.workbench.where import Failure


@dataclass(frozen=True, slots=True)
class AllTried:
    """The candidates on top of one model."""

    decision: Decision
    models: Mapping[str, Tried]
    """By the effect that was added."""

    @property
    def at_bound(self) -> tuple[str, ...]:
        """Parameters of the effect that was decided for which ran into a bound."""
        effect = self.decision.effect
        return () if effect is None else own_at_bound(self.models[effect].fit)


def judged(
    smaller: Step, models: Mapping[str, Tried], record: Record, null_p_of: Callable[[Fit], float]
) -> AllTried:
    """Judge effects by their held-out errors, and the winner by a simulated null as well.

    An effect must lower the error where it was fitted, too: what helps little there helps elsewhere by luck
    of the smaller model's folds. And it must lower the innovations, as no answer to the disturbance does.

    Args:
        smaller: The model without any of them.
        models: With each, the simplest of a family first.
        record: What they were fitted to.
        null_p_of: How likely the effect of a fit seems to explain as much where it is not there.
    """
    families = {name: each.fit.model.effects[-1].family for name, each in models.items()}
    losses = {name: each.held_out.losses for name, each in models.items()}
    enough = (1 - LEAST_PERCENT / 100) * smaller.fit.error
    stopped = [name for name, each in models.items() if own_at_bound(each.fit)]
    found = {
        name: evidence_of(smaller.fit, each.fit, record, len(models))
        for name, each in models.items()
        if each.fit.error <= enough
    }
    null_p = {name: 1.0 for name in models if name not in found or not found[name].more}
    chances = {name: each.by_chance for name, each in found.items()}
    likelier = {name: each.criterion for name, each in found.items()}
    once = {name for name, each in models.items() if happens_once(each.fit.model.effects[-1], record.facts)}
    asked: set[str] = set()
    while True:
        decision = judge(
            smaller.held_out.losses,
            losses,
            families,
            null_p,
            stopped,
            by_chance=chances,
            once=once,
            likelier=likelier,
        )
        effect = decision.effect
        if effect is None or (decision.kind == "suggested" and not decision.rivals):
            break
        new = [each for each in (effect, *decision.rivals) if each not in asked | null_p.keys()]
        asked.update(new)
        standing = {each for each in new if _stands_for_another(smaller, models[each], record)}
        null_p.update(dict.fromkeys(standing, 1.0))
        # Asked before rivals are compared: under a load that wanders the record may be likelier with what did
        # not happen than with what did.
        for each in once.intersection(new) - standing:
            null_p[each] = null_p_of(models[each].fit)
        if any(null_p.get(each, 0.0) >= LEVEL for each in new):
            continue
        unlikely = less_likely({each: found[each] for each in (effect, *decision.rivals)})
        if unlikely:
            null_p.update(dict.fromkeys(unlikely, 1.0))
            continue
        if decision.kind == "suggested" or effect in null_p:
            break
        null_p[effect] = null_p_of(models[effect].fit)
    if decision.effect is not None and null_p.get(decision.effect, 0.0) >= LEVEL:
        decision = replace(decision, kind="none", effect=None, family=None)
    return AllTried(decision, models)


def _stands_for_another(smaller: Step, larger: Tried, record: Record) -> bool:
    """Whether what made the smaller model fail is still there with the last effect of ``larger``.

    A wave that goes on all the time is seen by itself, whatever else is missing.
    """
    effect = larger.fit.model.effects[-1]
    of_op = acts_on_op(effect, record.facts) or happens_once(effect, record.facts)
    if larger.predicts is None or not of_op:
        return False
    return not resolves(smaller.estimate.dependence, state_dependence(*larger.predicts))


def own_at_bound(fitted: Fit) -> tuple[str, ...]:
    """Return the parameters of the last effect of a fit that ran into a bound."""
    effect = fitted.model.effects[-1].name
    return tuple(name for name in fitted.at_bound if name.startswith(f"{effect}."))


def verdict_of(found: AllTried, failures: Sequence[Failure], lines: LineSpectrum | None) -> Verdict:
    """Return what a model lacks, as far as its record tells.

    It fails visibly where its residual follows an axis, or holds a wave that comes from outside.
    """
    decision = found.decision
    if decision.kind != "none":
        return Verdict(
            decision.kind, decision.effect, decision.family, decision.indistinguishable, found.at_bound
        )
    fails = any(each.p < FOLLOWED for each in failures)
    waves = lines is not None and lines.from_outside
    return Verdict("none_of_the_known" if fails or waves else "no_failure_visible")


def naming(verdict: Verdict, name: str) -> Verdict:
    """Return the verdict with ``name`` in front, where it is one of those that cannot be told apart."""
    if verdict.effect is None or name not in verdict.indistinguishable:
        return verdict
    others = tuple(each for each in (verdict.effect, *verdict.indistinguishable) if each != name)
    return replace(verdict, effect=name, indistinguishable=others)
