"""Which of the effects that may be missing does a record confirm?

Each is a hypothesis of one set: that the model lacks it. One criterion compares them: how much likelier the
record is with an effect than without, all its numbers paid; before, each that was scored is as likely as any
other, and as nothing at all. What the held-out blocks say is how much an effect matters. A wave is apart, for
an autoregression predicts it: it is seen in the spectrum, and by held-out blocks, whatever else is missing.
So is everything in a record without predictions.

Source: R. Kass and A. Raftery, J. Am. Stat. Assoc. 90 (1995) 773; 5 % of the error: reference
``missing_effect.md`` section 4.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal

from agent.workbench.inputs.measured_input import FAMILY as MEASURED
from agent.workbench.paired_blocks import LEAST_PERCENT
from agent.workbench.residual.holm import LEVEL
from agent.workbench.residual.very_strong import STRONG, VERY_STRONG

DecisionKind = Literal["confirmed", "family", "suggested", "none"]
CONFIRMED: frozenset[DecisionKind] = frozenset({"confirmed", "family"})


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
    """That it reduces nothing, adjusted for all candidates."""
    objection: str | None = None
    """In words what rejects it; None where nothing does."""
    criterion: float = 0.0
    """How much likelier the record is with it, twice a logarithm, its numbers paid."""
    odds: float = -math.inf
    """The same with each candidate as likely before as any other: how sure it is, twice a logarithm; minus
    infinity where a check rejects it."""
    by_blocks: bool = False
    """Whether held-out blocks decide on it, and not its likelihood: its odds then only say whether what they
    show may be slow noise (0)."""
    once: bool = False
    """Whether it happened at an instant."""
    at_bound: bool = False
    """Whether a parameter ran into a bound: it stands for something else than what it is named for, or the
    record does not show how much of it there is."""

    @property
    def is_large(self) -> bool:
        """Whether it lowers the error by as much as counts."""
        return self.error_reduction_percent >= LEAST_PERCENT

    @property
    def log10_odds(self) -> float | None:
        """The odds as a power of ten; None where held-out blocks decide."""
        return None if self.by_blocks else self.odds / (2 * math.log(10.0))

    @property
    def is_likely(self) -> bool:
        """Whether the record is likelier with it than without; of a wave, whether held-out blocks show it."""
        return self.low > 0 and self.p < LEVEL if self.by_blocks else self.odds > 0.0

    @property
    def surprises(self) -> bool:
        """Whether it seems large enough to be confirmed, so that what rejects it must be stated."""
        return self.objection is not None and self.is_large and self.low > 0


@dataclass(frozen=True, slots=True)
class Decision:
    """What the record says of the candidates."""

    kind: DecisionKind
    """``family``: one of the family, it cannot be said which. ``suggested``: likely, but not by far; or no
    likelier than an effect of another family."""
    effect: str | None
    """Of those that cannot be distinguished the simplest of the likeliest one's family, one with which the
    record is far less likely, or with a parameter at a bound, last; of measured inputs the likeliest. None
    where there is none."""
    family: str | None
    indistinguishable: tuple[str, ...]
    """The others that cannot be distinguished from the likeliest."""
    rivals: tuple[str, ...]
    """Those of them that are of another family. Where the record holds both effects, adding one leaves the
    other to be confirmed above it; where it does not, either explains what the other does."""
    candidates: tuple[Candidate, ...]
    """The largest reduction first."""
    lacks: tuple[str, ...] = ()
    """In words what else the model lacks with the effect, or what makes it a suggestion."""


def decide(candidates: Sequence[Candidate], lower: Callable[[str, str], bool]) -> Decision:
    """Return the likeliest candidate that lowers the error by as much as counts, with those as good.

    No other is named in place of one that is far likelier and lowers the error by less. What held-out blocks
    show is named where nothing else is confirmed, where it is far likelier, though an autoregression predicts
    it, or where all else are events that make surely more error, though the blocks know when they happened.

    Args:
        candidates: The simplest of a family first.
        lower: Whether the first of two surely makes less held-out error, by as much as counts.
    """
    ranked = tuple(sorted(candidates, key=lambda each: -each.error_reduction_percent))
    likely, shown = _likeliest(candidates, lower), _shown_by_blocks(candidates, lower)
    by_odds, by_blocks = _of_set(likely, ranked), _of_set(shown, ranked)
    if by_odds.kind == "none":
        return by_blocks
    if by_blocks.kind not in CONFIRMED:
        return by_odds
    wave = shown[0]
    far = all(wave.criterion - each.criterion > VERY_STRONG for each in likely)
    events = all(each.once and lower(wave.effect, each.effect) for each in likely)
    return by_blocks if far or events or by_odds.kind not in CONFIRMED else by_odds


def _likeliest(candidates: Sequence[Candidate], lower: Callable[[str, str], bool]) -> list[Candidate]:
    """Return the likeliest that matters, and those as good.

    Of its family also those that may lower the error as much, for no law is quite that of the plant.
    """
    supported = [each for each in candidates if each.is_likely and not each.by_blocks]
    able = [each for each in supported if each.is_large]
    if not able:
        return []
    best = max(able, key=lambda each: each.criterion)
    others = (each.criterion for each in supported if each.family != best.family)
    if max(others, default=best.criterion) - best.criterion > VERY_STRONG:
        return []

    def as_good(each: Candidate) -> bool:
        as_likely = best.criterion - each.criterion <= STRONG
        return as_likely or (each.family == best.family and not lower(best.effect, each.effect))

    good = [each for each in able if as_good(each)]
    return sorted(good, key=lambda each: best.criterion - each.criterion > VERY_STRONG)


def _shown_by_blocks(candidates: Sequence[Candidate], lower: Callable[[str, str], bool]) -> list[Candidate]:
    """Return what lowers the held-out error most and surely, and what may lower it as much."""
    able = [
        each
        for each in candidates
        if each.by_blocks and each.objection is None and each.is_large and each.is_likely
    ]
    if not able:
        return []
    best = max(able, key=lambda each: each.error_reduction_percent)
    return [each for each in able if not lower(best.effect, each.effect)]


def _of_set(alike: Sequence[Candidate], ranked: tuple[Candidate, ...]) -> Decision:
    """Decide for those that cannot be distinguished, the simplest of a family first."""
    if not alike:
        return Decision("none", None, None, (), (), ranked)
    inside = [each for each in alike if not each.at_bound]
    best = max(inside or alike, key=lambda each: (each.criterion, each.error_reduction_percent))
    ordered = [*inside, *(each for each in alike if each.at_bound)]
    own = [each for each in ordered if each.family == best.family]
    if best.family == MEASURED:  # none of them is simpler, or contains another
        own.sort(key=lambda each: -each.criterion)
    family = [each.effect for each in own]
    rivals = tuple(each.effect for each in ordered if each.family != best.family)
    kind: DecisionKind = "family" if len(family) > 1 else "confirmed"
    if rivals or not inside or best.odds <= VERY_STRONG:
        kind = "suggested"
    return Decision(kind, family[0], best.family, (*family[1:], *rivals), rivals, ranked)
