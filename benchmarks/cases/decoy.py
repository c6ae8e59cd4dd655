"""A false effect: a random walk that is unrelated to the loop."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from agent.analysis.record.recording import FloatArray
from agent.physics.effect import Facts, Parameter, Stage

FAMILY = "decoy"


@dataclass(frozen=True, slots=True)
class Decoy:
    """Adds a walk with a coefficient that is solved for: to confirm it is a false confirmation."""

    seed: int
    stage: Stage = "disturbance"
    bases: tuple[str, ...] = ()

    @property
    def name(self) -> str:
        return f"decoy_{self.seed}"

    @property
    def family(self) -> str:
        return FAMILY

    def parameters(self, facts: Facts) -> tuple[Parameter, ...]:  # noqa: ARG002
        return ()

    def columns(self, time: FloatArray, response: FloatArray, values: FloatArray) -> FloatArray:  # noqa: ARG002
        walk = np.cumsum(np.random.default_rng(self.seed).standard_normal(len(time)))
        return np.asarray((walk / np.abs(walk).max())[:, np.newaxis], dtype=np.float64)
