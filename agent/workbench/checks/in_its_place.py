"""An effect that may be in the place of one that would be confirmed."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from agent.physics.effect import Effect


class InItsPlace(NamedTuple):
    """A rival of an effect."""

    effect: Effect
    words: str
    """What to say where it stands."""
    least: float
    """How much likelier the record must be with the effect that it rivals, twice a logarithm; below zero:
    the rival stands only where it is itself likelier by more."""
