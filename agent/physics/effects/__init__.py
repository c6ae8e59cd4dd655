"""Physical effects that a loop may have, one a file."""

from __future__ import annotations

from agent.physics.effect import Effect
from agent.physics.effects.deadband import Deadband
from agent.physics.effects.sinusoid import Sinusoid

__all__ = ["EFFECTS", "Effect"]

EFFECTS: tuple[Effect, ...] = (Deadband(), Sinusoid())
