"""Two effects that go on all the time against one event: hypotheses of one set, by one likelihood and price.

Steps of a load have heights, instants and a lag of their own, so that they may take over what two effects do,
where neither of these alone does as much. So an event is compared with the likeliest pair of effects that act
on OP, as it is with each of them alone; and with the likeliest one where no other gains beside it, even if
that stands for another cause: then this one acts on OP, and did not happen once. Where the record is far
likelier with the event beside them than with either, they explain another part of it and are no rivals.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from agent.workbench.evidence import evidence_of, far_likelier
from agent.workbench.residual.very_strong import VERY_STRONG

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping

    from agent.physics.effect import Effect
    from agent.workbench.evidence import Evidence
    from agent.workbench.record import Record
    from agent.workbench.step import Step
    from agent.workbench.trial import Optimum, Tried


class Pair(NamedTuple):
    """Two effects, or the one beside which none gains."""

    names: tuple[str, ...]
    criterion: float
    """How much likelier the record is with them: ``Evidence.criterion`` of one after one."""
    model: Optimum
    """With them."""


def likeliest_pair(
    found: Mapping[str, Evidence],
    models: Mapping[str, Tried],
    also: Callable[[Optimum], Iterable[Effect]],
    together: Callable[[Step | Optimum, Effect], Optimum],
    record: Record,
    tries: int,
) -> Pair | None:
    """Return the likeliest effects, two at most, that act on OP all the time; None where there are none.

    Args:
        found: What the innovations say of each effect on the smaller model.
        models: With each of them.
        also: Those that the innovations hint at beside the effect of a model, the best first.
        together: Tries an effect on top of one of the models.
        record: What they were fitted to.
        tries: How many effects were scored beside each.
    """
    able = [name for name, each in found.items() if each.answers and not each.once and each.odds > 0]
    if not able:
        return None
    first = max(able, key=lambda name: found[name].criterion)
    larger = {each.name: together(models[first], each) for each in also(models[first])}
    pairs = [
        Pair((first, name), found[first].criterion + second.criterion, each)
        for name, each in larger.items()
        if (second := evidence_of(models[first], each, record, tries)).answers and second.odds > 0
    ]
    alone = Pair((first,), found[first].criterion, models[first])
    return max(pairs, key=lambda each: each.criterion, default=alone)


def is_beside(
    pair: Pair, event: Tried, together: Callable[[Step | Optimum, Effect], Optimum], record: Record
) -> bool:
    """Return whether an event explains another part of the record than a pair does, so that it needs both."""
    both = together(pair.model, event.fit.model.effects[-1])
    return all(far_likelier(each, both, record) for each in (pair.model, event))


def far_likelier_than(pair: Pair, event: Evidence) -> bool:
    """Return whether the record is very much likelier with a pair than with an event."""
    return pair.criterion - event.criterion > VERY_STRONG


def far_likelier_words(pair: Pair) -> str:
    """Return in words that a pair rejects an event."""
    return f"with {_in_words(pair)} the record is far more likely than with what happened once"


def as_likely_words(pair: Pair) -> str:
    """Return in words that a pair cannot be distinguished from an event."""
    return f"with {_in_words(pair)} the record is as likely"


def is_as_likely(pair: Pair, event: Evidence) -> bool:
    """Return whether the record is not very much likelier with an event than with a pair."""
    return event.criterion - pair.criterion <= VERY_STRONG


def _in_words(pair: Pair) -> str:
    return " and ".join(each.replace("_", " ") for each in pair.names) + " together" * (len(pair.names) > 1)
