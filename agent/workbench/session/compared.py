"""A whole session in one value: its staircase, where the newest model fails, what was tried, the verdict."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from agent.workbench.comparison import Comparison, StepEvidence, not_testable
from agent.workbench.design.next_test import next_test
from agent.workbench.library import missing
from agent.workbench.residual.power import smallest_reduction
from agent.workbench.session.explained import explained_by_op, is_informative, not_informative_words
from agent.workbench.session.unseen import unseen
from agent.workbench.session.views import floor
from agent.workbench.step import Verdict
from agent.workbench.verdict import verdict_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agent.workbench.hypotheses import Candidate
    from agent.workbench.session.bench import Bench
    from agent.workbench.shown.information import Shown

FAILS = frozenset({"none_of_the_known", "suggested"})
"""Verdicts with which the model still fails."""


def compared(bench: Bench) -> Comparison:
    """Return the staircase of a session, and the verdict on its newest model."""
    if bench.reason is not None:
        return not_testable(bench.window.loop, bench.reason)
    tried = bench.tried()
    fails, spectrum = bench.where_it_fails(), bench.lines()
    candidates, rng = tried.decision.candidates, np.random.default_rng(0)
    smallest = None
    if candidates and bench.step.predicts is not None:
        samples = int(np.count_nonzero(bench.record.weight))
        smallest = smallest_reduction(samples, len(missing(bench.step.fit.model, bench.library)))
    verdict = verdict_of(bench.step, tried, fails, spectrum, bench.record.facts)
    if verdict.kind in FAILS:
        verdict = replace(verdict, lacks=(*verdict.lacks, *bench.other_base()))
    explained, reason = explained_by_op(bench.step, bench.trials), None
    waves = spectrum is not None and bool(spectrum.certain)
    if verdict.effect is None and not waves and not is_informative(explained, fails):
        verdict, reason = Verdict("not_testable"), not_informative_words(explained)
    shown = bench.trials.shown_on(bench.step, bench.library)
    return Comparison(
        loop=bench.window.loop,
        steps=bench.staircase(),
        evidence=_evidence(bench),
        where_it_fails=fails,
        lines=() if spectrum is None else spectrum.from_outside,
        candidates=candidates,
        verdict=verdict,
        noise_floor=floor(bench.step, bench.trials, rng),
        smallest_percent=smallest,
        reason=reason,
        unseen=unseen(bench, smallest),
        shown=shown,
        not_fitted=_not_fitted(bench, candidates, shown),
        not_validated=bench.not_validated,
        next_test=next_test(bench.step, verdict, dict(tried.models)),
    )


def _not_fitted(bench: Bench, candidates: Sequence[Candidate], shown: Sequence[Shown]) -> tuple[str, ...]:
    """Return the effects that are neither in the table nor named with a reason, in the library's order."""
    named = {each.effect for each in candidates} | bench.trials.left_out.keys()
    named |= {each.effect for each in shown if each.why_not is not None}
    possible = (each.name for each in missing(bench.step.fit.model, bench.library))
    return tuple(name for name in possible if name not in named)


def _evidence(bench: Bench) -> tuple[StepEvidence, ...]:
    """Return for each step what was known of the model before it."""
    found = [StepEvidence()]
    for before, step in pairwise(bench.staircase()):
        known = bench.trials.known(before)
        if step.added is None:
            found.append(StepEvidence())
        else:
            tried = () if known is None else known.decision.candidates
            found.append(StepEvidence(bench.failures_of(before), tried))
    return tuple(found)
