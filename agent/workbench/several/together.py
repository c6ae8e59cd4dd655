"""Which effect is missing in several recordings of one loop, from one model over all of them.

Likelihood decides, as in one recording: an effect makes all recordings together very much likelier, and no
effect of another family is nearly as likely. It must also lower the error of each recording that its fit did
not use, taken together, and nothing on which the smaller model failed may remain in any.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from agent.workbench.candidates import WORSE_ELSEWHERE
from agent.workbench.checks.own_cycle import WORDS as OWN_CYCLE
from agent.workbench.checks.own_cycle import may_be_loops_own
from agent.workbench.checks.wave_lines import NO_LINE, UNCERTAIN, line_of
from agent.workbench.library import happens_once, missing
from agent.workbench.paired_blocks import LEAST_PERCENT
from agent.workbench.residual.state_dependence import fails, removed_by, state_dependence, still_fails
from agent.workbench.residual.very_strong import VERY_STRONG, very_strong
from agent.workbench.session import Workbench
from agent.workbench.session.automatic import MOST_EFFECTS
from agent.workbench.session.opening import validation
from agent.workbench.several.joint import JointFit
from agent.workbench.several.joint_step import JointJob, JointStep, joint_step
from agent.workbench.shown.score import promising, scores_of
from agent.workbench.step import Verdict

if TYPE_CHECKING:
    from collections.abc import Mapping

    from agent.analysis.record.recording import FloatArray, LoopWindow
    from agent.physics.effect import Effect
    from agent.workbench.predictor import Predictor
    from agent.workbench.record import Record
    from agent.workbench.trial import Tried

NOT_LOWER = "it does not lower the error of recordings that its fit did not use"
STANDS_FOR_ANOTHER = "with it the model still fails as before: it stands for another cause"
UNLIKELY = "the recordings together are hardly likelier with it"


@dataclass(frozen=True, slots=True)
class JointCandidate:
    """An effect that was fitted to all recordings at once."""

    effect: str
    family: str
    criterion: float
    """How much likelier all recordings are with it, twice a logarithm, its numbers paid."""
    error_reduction_percent: float
    """Of the held-out squared error, mean of the recordings."""
    objection: str | None
    """In words why it is not confirmed; None where nothing speaks against it."""


@dataclass(frozen=True, slots=True)
class Together:
    """What several recordings of one loop say together."""

    recordings: tuple[str, ...]
    left_out: Mapping[str, str]
    """Recordings that could not be used, and why."""
    steps: tuple[JointStep, ...]
    candidates: tuple[JointCandidate, ...]
    """On top of the last step, the likeliest first."""
    verdict: Verdict
    not_validated: str | None = None
    """In plain words why nothing could be scored on the other recording; None where it could, or without."""

    @property
    def verdict_words(self) -> str:
        """The verdict in words, without its stop."""
        verdict = self.verdict
        others = f", or {', '.join(verdict.indistinguishable)}" if verdict.indistinguishable else ""
        effect = "" if verdict.effect is None else f": {verdict.effect}{others}"
        return "; ".join((f"{verdict.kind}{effect}".replace("_", " "), *verdict.lacks))


def compared_together(
    benches: Mapping[str, Workbench],
    own: Collection[str],
    *,
    auto: bool,
    validate: LoopWindow | None = None,
) -> Together:
    """Compare recordings of one loop with one model.

    What happened once belongs to one recording and is not tried here.

    Args:
        benches: By the name of the recording, each with its base fitted.
        own: Parameters that each recording has for itself.
        auto: Add what is confirmed until nothing more is.
        validate: Another recording of the loop; every step is scored on it, nothing fitted. One on which
            nothing can be scored does no harm: ``not_validated`` says why.

    Raises:
        ValueError: Fewer than two recordings can be used, or their base has no predictions.
    """
    reasons = {name: _why_not(bench) for name, bench in benches.items()}
    left_out = {name: why for name, why in reasons.items() if why is not None}
    used = {name: bench for name, bench in benches.items() if name not in left_out}
    if len(used) < 2:
        words = "; ".join(f"{name}: {why}" for name, why in left_out.items())
        raise ValueError(f"two recordings at least are needed that can be compared ({words})")
    first = next(iter(used.values()))
    other, not_validated = validation(validate, first.base, first.installed)
    several = _Several(tuple(used.values()), frozenset(own), other)
    steps = [several.base()]
    while True:
        models, candidates, verdict = several.candidates(steps[-1])
        go_on = auto and verdict.kind in {"confirmed", "family"} and len(steps) <= MOST_EFFECTS
        if not go_on or verdict.effect is None:
            return Together(tuple(used), left_out, tuple(steps), candidates, verdict, not_validated)
        steps.append(several.taken(models[verdict.effect], verdict.effect))


@dataclass(frozen=True, slots=True)
class _Tried:
    step: JointStep
    alone: tuple[Tried, ...]
    """In each recording by itself."""


@dataclass(frozen=True, slots=True)
class _Several:
    benches: tuple[Workbench, ...]
    own: frozenset[str]
    other: Record | None
    """For validation."""

    def base(self) -> JointStep:
        found = joint_step(self._job([bench.step.predicts for bench in self.benches], None))
        if found is None:
            raise ValueError("the recordings have too few samples in a row")
        return found

    def taken(self, found: _Tried, effect: str) -> JointStep:
        """Make a model the newest of each recording."""
        for bench, alone in zip(self.benches, found.alone, strict=True):
            bench.take(alone, added=effect)
        return found.step

    def candidates(self, smaller: JointStep) -> tuple[dict[str, _Tried], tuple[JointCandidate, ...], Verdict]:
        """Fit what the innovations of all recordings together hint at, and judge it."""
        first = self.benches[0]
        able = [
            each
            for each in missing(first.step.fit.model, first.library)
            if not happens_once(each, first.record.facts)
        ]
        scores: dict[str, float] = {}
        for bench in self.benches:
            own = [bench.effect(each.name) for each in able]  # an input has its own course in each
            for name, score in scores_of(own, *_predictions(bench.step.predicts)).items():
                scores[name] = scores.get(name, 0.0) + score
        tried = self._tried(promising(able, scores))
        candidates = tuple(
            sorted((self._judged(smaller, each) for each in tried.values()), key=lambda each: -each.criterion)
        )
        candidates = tuple(
            each
            if each.objection is not None or very_strong(each.criterion, len(able))
            else replace(each, objection=UNLIKELY)
            for each in candidates
        )
        visible = any(fails(bench.step.estimate.dependence) for bench in self.benches)
        return tried, candidates, self._lowered(_verdict(candidates, visible=visible), smaller, tried)

    def _lowered(self, verdict: Verdict, smaller: JointStep, tried: Mapping[str, _Tried]) -> Verdict:
        """Return a verdict, lowered where validation is worse, or the loop may make a wave itself."""
        if verdict.effect is None:
            return verdict
        rows = list(zip(self.benches, tried[verdict.effect].alone, strict=True))
        if all(line_of(bench.step.predicts, alone.fit) in UNCERTAIN for bench, alone in rows):
            return replace(verdict, kind="suggested", lacks=(NO_LINE,))
        if any(may_be_loops_own(bench.step.predicts, alone.fit) for bench, alone in rows):
            return replace(verdict, kind="suggested", lacks=(OWN_CYCLE,))
        before, after = smaller.rmse_validation, tried[verdict.effect].step.rmse_validation
        if before is None or after is None or after <= before:
            return verdict
        return replace(verdict, kind="suggested", lacks=(WORSE_ELSEWHERE,))

    def _tried(self, effects: Sequence[Effect]) -> dict[str, _Tried]:
        """Return the models with each effect; one that failed in a recording is reported by its trial."""
        own = [(bench, [bench.effect(each.name) for each in effects]) for bench in self.benches]
        alone = [bench.trials.models_on(bench.step, able) for bench, able in own]
        names = [each.name for each in effects if all(each.name in models for models in alone)]
        jobs = [self._job([models[name].predicts for models in alone], name) for name in names]
        steps = self.benches[0].trials.run(joint_step, jobs)
        return {
            name: _Tried(step, tuple(models[name] for models in alone))
            for name, step in zip(names, steps, strict=True)
            if step is not None
        }

    def _job(self, predicts: Sequence[tuple[Predictor, FloatArray] | None], added: str | None) -> JointJob:
        return JointJob(tuple(map(_predictions, predicts)), self.own, self.other, added)

    def _judged(self, smaller: JointStep, found: _Tried) -> JointCandidate:
        effect = found.step.fitted.fits[0].model.effects[-1]
        errors = np.array(found.step.rmse_held_out) ** 2 / np.array(smaller.rmse_held_out) ** 2
        percent = 100 * float(1 - errors.mean())
        objection = NOT_LOWER if percent < LEAST_PERCENT else None
        if objection is None and self._still_fails(found.step.fitted):
            objection = STANDS_FOR_ANOTHER
        criterion = smaller.fitted.unlikely - found.step.fitted.unlikely
        return JointCandidate(effect.name, effect.family, criterion, percent, objection)

    def _still_fails(self, fitted: JointFit) -> bool:
        """Return whether what made the smaller model fail in a recording is still there."""
        rows = zip(self.benches, fitted.joint.predictors, fitted.joint.values(fitted.at), strict=True)
        return any(
            still_fails(
                bench.step.estimate.dependence,
                state_dependence(*larger),
                removed_by(bench.step.predicts, larger),
            )
            for bench, predicts, values in rows
            for larger in [(predicts, predicts.space.at(values))]
        )


def _verdict(candidates: Sequence[JointCandidate], *, visible: bool) -> Verdict:
    """Return the likeliest effect, with those that are nearly as likely; a rejected one excludes no other.

    ``visible``: the smaller model fails on an axis in a recording.
    """
    able = [each for each in candidates if each.objection is None]
    if not able:
        return Verdict("none_of_the_known" if visible else "no_failure_visible")
    best = able[0]
    alike = [each for each in able if best.criterion - each.criterion <= VERY_STRONG]
    others = tuple(each.effect for each in alike[1:])
    if any(each.family != best.family for each in alike):
        return Verdict("suggested", best.effect, best.family, others)
    return Verdict("family" if others else "confirmed", best.effect, best.family, others)


def _why_not(bench: Workbench) -> str | None:
    """Return why a recording cannot be used; None where it can."""
    if bench.reason is not None:
        return bench.reason
    return "its base predicts nothing" if bench.step.predicts is None else None


def _predictions(found: tuple[Predictor, FloatArray] | None) -> tuple[Predictor, FloatArray]:
    if found is None:
        raise ValueError("a base without predictions is compared one recording at a time")
    return found
