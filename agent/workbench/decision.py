"""Which of the effects that were tried does the record confirm?

Source: reference ``missing_effect.md`` section 4, steps 5 and 6: thresholds 5 % and p < 0.05 after Holm.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal

import numpy as np

from agent.workbench.likeliest import less_likely
from agent.workbench.paired_blocks import reduction, sign_flip_p
from agent.workbench.residual.holm import LEVEL, holm
from agent.workbench.residual.very_strong import STRONG

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping, Sequence

    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]

SUGGESTED = 0.2
"""Below it an effect is worth a look. Of 12 that are not there, none is in four records of five."""
LEAST_PERCENT = 5.0
"""Smaller reductions of the held-out error are no effect, however significant."""

DecisionKind = Literal["confirmed", "family", "suggested", "none"]


@dataclass(frozen=True, slots=True)
class Candidate:
    """An effect that was added to the model and refitted."""

    effect: str
    family: str
    error_reduction_percent: float
    """Of the held-out mean squared error."""
    low: float
    """Lower end of its 90 % interval."""
    high: float
    p: float
    """That it reduces nothing: adjusted for all candidates, and of an input not below that by chance."""
    objection: str | None = None
    """In words what rejects it, however small ``p`` is; None where nothing does."""

    @property
    def surprises(self) -> bool:
        """Whether it seems large enough to be confirmed, so that what rejects it must be stated."""
        return self.objection is not None and _is_large(self.error_reduction_percent, self.low)


@dataclass(frozen=True, slots=True)
class Decision:
    """What the record says of the candidates."""

    kind: DecisionKind
    """``family``: one of the family, it cannot be said which. ``suggested``: not significant, or no better
    than an effect of another family."""
    effect: str | None
    """Of those that cannot be distinguished the simplest of the best one's family, but one with which the
    record is far less likely, or with a parameter at a bound, last; None where there is none."""
    family: str | None
    indistinguishable: tuple[str, ...]
    """The others that cannot be distinguished from the best."""
    rivals: tuple[str, ...]
    """Those of them that are of another family. Where the record holds both effects, adding one leaves the
    other to be confirmed above it; where it does not, either explains what the other does."""
    candidates: tuple[Candidate, ...]
    """The largest reduction first."""
    lacks: tuple[str, ...] = ()
    """In words what else the model lacks with the effect, or what makes it a suggestion."""


def judge(
    losses_base: FloatArray,
    losses: Mapping[str, FloatArray],
    families: Mapping[str, str],
    at_bound: Collection[str] = (),
    *,
    by_chance: Mapping[str, float] | None = None,
    input_p: Mapping[str, float] | None = None,
    seen: Collection[str] = (),
    likelier: Mapping[str, float] | None = None,
    comparable: Collection[str] = (),
    objections: Mapping[str, str] | None = None,
    rng: np.random.Generator | None = None,
) -> Decision:
    """Judge candidates by their held-out errors.

    An effect is confirmed where it reduces the error by at least ``LEAST_PERCENT``, and p, adjusted by Holm,
    is below ``LEVEL``: by the blocks or by chance. The interval of the reduction must be above zero but for
    what is shown by chance.
    The best is that with the least error, or, where it is comparable, the likeliest that is. Another differs
    from the best by the same rule: where the best reduces its error by as much, as significantly, and the
    record is not likelier with it.

    Args:
        losses_base: Squared error of each held-out block without any of the candidates, (b,), b >= 2, one of
            them > 0. A block that is NaN for one model counts for none.
        losses: The same with each candidate, the simplest of a family first.
        families: Of each candidate.
        at_bound: Candidates of which a parameter ran into a bound: they stand for something else than what
            they are named for, or the record does not show how much of them there is. None is confirmed.
        by_chance: How likely an effect lowers the innovations as far where it is not there, all candidates
            paid for. Where that is less than the p of the held-out blocks it counts instead: an effect that
            acts in few blocks cannot be significant by their signs, however plain it is there, and under a
            load that wanders blocks scatter more than what an effect does in them.
        input_p: Of measured inputs: how likely one explains as much where it does not act. It must be below
            ``LEVEL`` as well.
        seen: Candidates of which blocks are not blind (``Evidence.blind``): p of their signs does not count,
            only ``by_chance``.
        likelier: How much likelier the record is with a candidate (``Evidence.criterion``). A wave has
            none: an autoregression predicts it, so that others seem likelier.
        comparable: Candidates that act on OP all the time. Between families of them the likelihood decides
            alone: one that lowers the error, and with which the record is not strongly less likely than with
            the best, cannot be distinguished from it. Not if the best happened once, or is a wave, which
            innovations hardly show.
        objections: Candidates that something rejects whatever their p, and what; none is confirmed.
        rng: Of the bootstrap; None: always the same draws.
    """
    draws = np.random.default_rng(0) if rng is None else rng
    known = np.all(np.isfinite([losses_base, *losses.values()]), axis=0)
    base = losses_base[known]
    own = {effect: np.asarray(each)[known] for effect, each in losses.items()}
    raw = np.array([sign_flip_p(base, each) for each in own.values()])
    adjusted = dict(zip(own, holm(raw).tolist(), strict=True))
    adjusted.update(dict.fromkeys(seen, 1.0))
    for effect, chance in (by_chance or {}).items():
        adjusted[effect] = min(adjusted[effect], chance)
    ranked, rejected, inputs = [], objections or {}, input_p or {}
    for effect, mine in own.items():
        found, objection = reduction(base, mine, draws), rejected.get(effect)
        p_all = max(adjusted[effect], inputs.get(effect, 0.0))
        numbers = found.percent, found.low, found.high, p_all
        ranked.append(Candidate(effect, families[effect], *numbers, objection))
    ranked.sort(key=lambda each: -each.error_reduction_percent)
    shown = {each for each, chance in (by_chance or {}).items() if chance < LEVEL}
    large = [
        each
        for each in ranked
        if each.error_reduction_percent >= LEAST_PERCENT and (each.low > 0 or each.effect in shown)
    ]
    confirmed = [each for each in large if each.p < LEVEL and each.objection is None]
    if confirmed:
        likely = likelier or {}
        best = _likeliest([each for each in confirmed if each.effect in comparable], confirmed[0], likely)
        sure = [each for each in large if each.low > 0 or best.low <= 0]
        alike = _as_good(best, sure, own, likely, comparable, draws)
        kin = {each for each in alike & likely.keys() if families[each] == best.family}
        poor = less_likely({each: likely[each] for each in kin})
        ordered = sorted((effect for effect in own if effect in alike), key=poor.__contains__)
        inside = [effect for effect in ordered if effect not in at_bound]
        outside = [effect for effect in ordered if effect in at_bound]
        if inside and best.effect in at_bound:
            best = next(each for each in confirmed if each.effect in inside)
        decided = _of_set(best, inside + outside, families, tuple(ranked))
        return decided if inside else replace(decided, kind="suggested")
    able = [each for each in large if each.objection is None and adjusted[each.effect] < SUGGESTED]
    if able:
        best = min(able, key=lambda each: each.p)
        return Decision("suggested", best.effect, best.family, (), (), tuple(ranked))
    return Decision("none", None, None, (), (), tuple(ranked))


def _as_good(
    best: Candidate,
    large: Sequence[Candidate],
    losses: Mapping[str, FloatArray],
    likely: Mapping[str, float],
    comparable: Collection[str],
    rng: np.random.Generator,
) -> set[str]:
    """Return the effects that cannot be distinguished from the best, itself among them.

    Between families of what acts on OP the likelihood decides, and for all else the held-out error.
    """
    judges = best.effect in comparable
    alike = set()
    for each in large:
        if each.objection is not None:
            continue
        if judges and each.effect in comparable and each.family != best.family:
            good = likely[best.effect] - likely[each.effect] <= STRONG
        else:
            likelier = likely.get(each.effect, -np.inf) >= likely.get(best.effect, np.inf)
            alone = each.p < LEVEL
            good = alone and (likelier or not _is_distinct(losses[best.effect], losses[each.effect], rng))
        if good:
            alike.add(each.effect)
    return alike


def _likeliest(able: Sequence[Candidate], best: Candidate, likely: Mapping[str, float]) -> Candidate:
    """Return the likeliest of those between which the likelihood decides, where the best is one of them.

    In free run the one that hides more of OP's answer has less error; the innovations know nothing of that.
    """
    return max(able, key=lambda each: likely[each.effect]) if best in able else best


def _is_large(percent: float, low: float) -> bool:
    return percent >= LEAST_PERCENT and low > 0


def _is_distinct(best: FloatArray, other: FloatArray, rng: np.random.Generator) -> bool:
    """Whether ``best`` beats ``other`` as an effect must beat the base."""
    found = reduction(other, best, rng)
    return _is_large(found.percent, found.low) and sign_flip_p(other, best) < LEVEL


def _of_set(
    best: Candidate, alike: list[str], families: Mapping[str, str], ranked: tuple[Candidate, ...]
) -> Decision:
    """Decide for those that cannot be distinguished, in the order in which they are to be named."""
    family = [effect for effect in alike if families[effect] == best.family]
    rivals = tuple(effect for effect in alike if effect not in family)
    others = (*family[1:], *rivals)
    kind: DecisionKind = "suggested" if rivals else "family" if others else "confirmed"
    return Decision(kind, family[0], best.family, others, rivals, ranked)
