"""What a model lacks, in one verdict."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from agent.workbench.checks.mended import LITTLE, mended_by
from agent.workbench.residual.state_dependence import LEVEL as FOLLOWED
from agent.workbench.step import Step, Verdict

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agent.physics.effect import Facts
    from agent.workbench.candidates import AllTried
    from agent.workbench.residual.line_spectrum import LineSpectrum
    from agent.workbench.residual.where import Failure


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
    mends = mended_by(decision.candidates, found.models, step.estimate.dependence, found.lowered)
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
