"""All effects that were tried on top of one model, judged together."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from agent.workbench.decision import LEAST_PERCENT, LEVEL, Decision, judge
from agent.workbench.step import Step, Verdict

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agent.workbench.fit import Fit
    from agent.workbench.trial import Tried
    from agent.workbench.where import Failure

REJECTED = 0.05
"""p of a panel below which the model fails visibly."""


@dataclass(frozen=True, slots=True)
class AllTried:
    """The candidates on top of one model."""

    decision: Decision
    models: Mapping[str, Tried]
    """By the effect that was added."""


def judged(smaller: Step, models: Mapping[str, Tried], null_p_of: Callable[[Fit], float]) -> AllTried:
    """Judge effects by their held-out errors, and the winner by a simulated null as well.

    Args:
        smaller: The model without any of them.
        models: With each, the simplest of a family first.
        null_p_of: How likely the effect of a fit seems to explain as much where it is not there.
    """
    families = {name: each.fit.model.effects[-1].family for name, each in models.items()}
    losses = {name: each.held_out.losses for name, each in models.items()}
    # What helps little where it was fitted helps elsewhere by luck of the smaller model's folds.
    enough = (1 - LEAST_PERCENT / 100) * smaller.fit.error
    null_p = {name: 1.0 for name, each in models.items() if each.fit.error > enough}
    while True:
        decision = judge(smaller.held_out.losses, losses, families, null_p)
        if decision.effect is None or decision.kind == "suggested" or decision.effect in null_p:
            break
        null_p[decision.effect] = null_p_of(models[decision.effect].fit)
    if decision.effect is not None and null_p.get(decision.effect, 0.0) >= LEVEL:
        decision = replace(decision, kind="none", effect=None, family=None)
    return AllTried(decision, models)


def verdict_of(decision: Decision, failures: Sequence[Failure]) -> Verdict:
    """Return what a model lacks, as far as its record tells."""
    if decision.kind != "none":
        return Verdict(decision.kind, decision.effect, decision.family, decision.indistinguishable)
    fails = any(each.p < REJECTED for each in failures)
    return Verdict("none_of_the_known" if fails else "no_failure_visible")


def naming(verdict: Verdict, name: str) -> Verdict:
    """Return the verdict with ``name`` in front, where it is one of those that cannot be told apart."""
    if verdict.effect is None or name not in verdict.indistinguishable:
        return verdict
    others = tuple(each for each in (verdict.effect, *verdict.indistinguishable) if each != name)
    return replace(verdict, effect=name, indistinguishable=others)
