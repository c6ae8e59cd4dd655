"""All effects that were tried on top of one model, judged together."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from agent.workbench.checks.adequate import adequate
from agent.workbench.checks.doubts import UNLIKELY, Doubt, Tries
from agent.workbench.checks.lacking import OF_A_LAW, may_be_of_a_law
from agent.workbench.checks.pairs import far_likelier_words
from agent.workbench.checks.rivals import against_rivals, untried_words
from agent.workbench.checks.unnamed import AS_LIKELY, LINEAR, dynamics_on
from agent.workbench.checks.wave_lines import SLOW, SLOW_LINE, is_wave, wave_objections
from agent.workbench.hypotheses import CONFIRMED, Candidate, Decision, decide
from agent.workbench.paired_blocks import known_blocks, lowers_error, reduction, sign_flip_p
from agent.workbench.residual.holm import LEVEL, holm
from agent.workbench.residual.very_strong import VERY_STRONG

if TYPE_CHECKING:
    from collections.abc import Iterable

    from agent.analysis.record.recording import FloatArray
    from agent.physics.effect import Effect
    from agent.workbench.checks.pairs import Pair
    from agent.workbench.fit import Fit
    from agent.workbench.step import Step
    from agent.workbench.trial import Optimum, Tried


WORSE_ELSEWHERE = "with it the model follows the recording for validation less well"
ANSWERS = "the innovations do not fall: it repeats what the controller does"
BY_CHANCE = "the innovations show no such event: one as large appears by chance"
BY_COURSE = "the innovations do not fall: slow noise goes along with its course as well"


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
    tries: Tries,
    worse: Callable[[Fit, Fit], bool],
    also: Callable[[Optimum], Iterable[Effect]],
    untried_rivals: Iterable[Effect],
) -> AllTried:
    """Judge effects as hypotheses of one set, and check what would be named.

    Args:
        tries: What was tried, the simplest of a family first.
        worse: Whether a larger model, the second, follows another recording less well than a smaller one.
        also: What of the library the innovations hint at beside an effect, the best first.
        untried_rivals: Effects that may be there, but that were not tried.
    """
    candidates, losses = _candidates(tries)

    @cache
    def lower(one: str, other: str) -> bool:
        return lowers_error(losses[other], losses[one], LEVEL)

    doubts: dict[str, Doubt] = {}
    while True:
        decision = decide(candidates, lower)
        new = [
            each for each in (decision.effect, *decision.rivals) if each is not None and each not in doubts
        ]
        doubts.update({each: tries.doubt(each) for each in new})
        if not any(doubts[each].rejects for each in new):
            break
        candidates = [
            replace(each, objection=doubts[each.effect].rejects, odds=-np.inf)
            if each.effect in new and doubts[each.effect].rejects
            else each
            for each in candidates
        ]
    decision = _lowered(_or_pair(decision, doubts, tries), doubts, tries, worse)
    if tries.smaller.predicts is not None and decision.kind in CONFIRMED:
        rivals = (
            *_unnamed(decision, tries.smaller),
            *((each, untried_words(each)) for each in untried_rivals),
        )
        decision = against_rivals(decision, tries.smaller, tries.found, rivals, tries.together, tries.record)
    if tries.smaller.predicts is not None and decision.kind in CONFIRMED:
        decision = adequate(decision, tries.models, tries.found, also, tries.together, tries.record)
    decision = replace(decision, candidates=_explained(decision, tries))
    return AllTried(decision, tries.models, frozenset(name for name, each in doubts.items() if each.lowers))


def _candidates(tries: Tries) -> tuple[list[Candidate], dict[str, FloatArray]]:
    """Return what was tried, with all that decides on it, and the held-out error of each block, (b,)."""
    smaller, found = tries.smaller, tries.found
    names = list(tries.models)
    base, *losses = known_blocks(
        smaller.held_out.losses, *(each.held_out.losses for each in tries.models.values())
    )
    signs = holm(np.array([sign_flip_p(base, each) for each in losses]))
    objections = wave_objections(smaller.predicts, tries.models, found)
    rng, candidates = np.random.default_rng(0), []
    for name, own, p_of_signs in zip(names, losses, signs.tolist(), strict=True):
        each, less = found[name], reduction(base, own, rng)
        # An effect that acts in few blocks cannot be significant by their signs, however plain it is there.
        p = min(p_of_signs if each.blind else 1.0, each.by_chance)
        by_blocks, odds, objection = _is_by_blocks(tries, name), each.odds, objections.get(name)
        if by_blocks:
            odds, objection = (0.0, None) if objection == SLOW_LINE else (np.inf, objection)
        elif each.once and not each.plain:
            odds = -np.inf
        candidates.append(
            Candidate(
                effect=name,
                family=each.family,
                error_reduction_percent=less.percent,
                low=less.low,
                high=less.high,
                p=p,
                objection=objection,
                criterion=each.criterion,
                odds=odds,
                by_blocks=by_blocks,
                once=each.once,
                at_bound=bool(own_at_bound(tries.models[name])),
            )
        )
    return candidates, dict(zip(names, losses, strict=True))


def _is_by_blocks(tries: Tries, name: str) -> bool:
    return tries.smaller.predicts is None or is_wave(tries.models[name].fit)


def _or_pair(decision: Decision, doubts: Mapping[str, Doubt], tries: Tries) -> Decision:
    """Return the suggestion of effects that are far likelier than an event, where none stands alone.

    Where each is confirmed beside the other, ``--auto`` adds both, as it does with rivals.
    """
    pair = _pair_of(doubts)
    if decision.kind != "none" or pair is None:
        return decision
    first, *others = pair.names
    beside = tuple(each for each in others if each in tries.models)
    family = tries.found[first].family
    return replace(
        decision, kind="suggested", effect=first, family=family, indistinguishable=beside, rivals=beside
    )


def _lowered(
    decision: Decision,
    doubts: Mapping[str, Doubt],
    tries: Tries,
    worse: Callable[[Fit, Fit], bool],
) -> Decision:
    """Return a decision with what it lacks in words, lowered to a suggestion where a check says so."""
    effect = decision.effect
    if effect is None:
        return decision
    model, found, doubt = tries.models[effect], tries.found[effect], doubts.get(effect, Doubt())
    words, pair = doubt.lowers, _pair_of(doubts)
    if words is None and is_wave(model.fit) and _odds(decision, effect) == 0.0:
        words = SLOW_LINE
    if words is None and may_be_of_a_law(found, tries.smaller.of_laws):
        words = OF_A_LAW
    if words is None and decision.kind in CONFIRMED and worse(tries.smaller.fit, model.fit):
        words = WORSE_ELSEWHERE
    both = None if pair is None or effect != pair.names[0] else far_likelier_words(pair)
    lacks = tuple(each for each in (words, both, doubt.lacks) if each is not None)
    return replace(decision, kind=decision.kind if words is None else "suggested", lacks=lacks)


def _pair_of(doubts: Mapping[str, Doubt]) -> Pair | None:
    """Return the effects that rejected an event."""
    return next((each.pair for each in doubts.values() if each.pair is not None), None)


def _odds(decision: Decision, effect: str) -> float:
    return next(each.odds for each in decision.candidates if each.effect == effect)


def _unnamed(decision: Decision, smaller: Step) -> tuple[tuple[Effect, str], ...]:
    """Return linear dynamics without a name as a rival; none of an effect that is a part of them."""
    return () if decision.family in LINEAR else ((dynamics_on(smaller.fit.model.base), AS_LIKELY),)


def _explained(decision: Decision, tries: Tries) -> tuple[Candidate, ...]:
    """Return the candidates with words for why one that seems large enough is not named."""
    candidates, named = decision.candidates, {decision.effect, *decision.indistinguishable}
    stepped = tries.record.facts.stepped  # in manual nothing answers PV
    likely = [each for each in candidates if not each.by_blocks and each.is_likely]

    def words(each: Candidate) -> str | None:
        if each.objection is not None or each.by_blocks or each.effect in named:
            return each.objection or (None if each.odds else SLOW_LINE)
        if not each.is_likely:
            if tries.found[each.effect].answers:
                return SLOW if stepped else ANSWERS
            return BY_CHANCE if each.once else BY_COURSE
        ahead = max(other.criterion for other in likely)
        return UNLIKELY if ahead - each.criterion > VERY_STRONG else None

    return tuple(replace(each, objection=words(each)) for each in candidates)


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
