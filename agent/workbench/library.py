"""Which effects may be tried on which base."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeVar, cast

import numpy as np

from agent.physics.bases import BASES, Base
from agent.physics.effect import Effect

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from agent.physics.effect import DisturbanceEffect, Facts
    from agent.physics.loop_model import LoopModel

Named = TypeVar("Named", Base, Effect)

ONE_OF_A_KIND = frozenset({"valve_hysteresis", "extra_lag"})
"""Families whose members describe the same property: a model has one of them."""


def base_named(name: str) -> Base:
    """Return the base of that name.

    Raises:
        ValueError: there is none; the text lists those that there are.
    """
    return _named(name, BASES, "base")


def effect_named(name: str, effects: Sequence[Effect]) -> Effect:
    """Return the effect of that name.

    Raises:
        ValueError: there is none; the text lists those that there are.
    """
    return _named(name, effects, "effect")


def library(effects: Sequence[Effect], base: Base, without: Iterable[str] = ()) -> tuple[Effect, ...]:
    """Return the effects that apply to a base, but for those of which ``without`` has the name or the family.

    Raises:
        ValueError: ``without`` has a name that is neither an effect nor a family.
    """
    known = {each.name for each in effects} | {each.family for each in effects}
    out = set(without)
    for word in sorted(out - known):
        raise ValueError(f"no effect or family {word!r}; there are {', '.join(sorted(known))}")
    return tuple(each for each in effects if applies(each, base) and not {each.name, each.family} & out)


def applies(effect: Effect, base: Base) -> bool:
    """Return whether an effect can act on a base: a process effect works on certain processes only."""
    if effect.bases:
        return base.name in effect.bases
    return base.linear or effect.stage != "process"


def missing(model: LoopModel, effects: Iterable[Effect]) -> tuple[Effect, ...]:
    """Return the effects that may be added to a model."""
    names = {each.name for each in model.effects}
    taken = {each.family for each in model.effects} & ONE_OF_A_KIND
    return tuple(each for each in effects if each.name not in names and each.family not in taken)


def acts_on_op(effect: Effect, facts: Facts) -> bool:
    """Return whether an effect depends on OP, so that it can follow a disturbance that OP responds to."""
    if effect.stage != "disturbance":
        return True
    values = np.array([0.5 * (each.low + each.high) for each in effect.parameters(facts)])
    time = np.asarray(facts.ts * np.arange(facts.samples), dtype=np.float64)
    columns = cast("DisturbanceEffect", effect).columns
    return not np.array_equal(columns(time, np.zeros_like(time), values), columns(time, time, values))


def happens_once(effect: Effect, facts: Facts) -> bool:
    """Return whether an effect is an event at an instant of the record."""
    return effect.stage == "disturbance" and any(each.of_record for each in effect.parameters(facts))


def instants(effect: Effect, facts: Facts) -> int:
    """Return how many of an effect's numbers are instants of the record."""
    return sum(each.instant for each in effect.parameters(facts))


def _named(name: str, members: Sequence[Named], kind: str) -> Named:
    for each in members:
        if each.name == name:
            return each
    raise ValueError(f"no {kind} {name!r}; there are {', '.join(each.name for each in members)}")
