"""A model of a loop from OP to PV: valve effects, process and its effects, sensor effects, disturbances."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, cast

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from agent.physics.bases.base import Base
    from agent.physics.effect import (
        DisturbanceEffect,
        Effect,
        Facts,
        Parameter,
        ProcessEffect,
        SensorEffect,
        ValveEffect,
    )

    FloatArray = NDArray[np.float64]

CHAIN = ("valve_speed", "extra_lag", "valve_hysteresis", "valve_limits", "valve_characteristic")
"""Families of valve effects from the controller's side to the flow's; one that is not here acts last."""


@dataclass(frozen=True, slots=True)
class LoopModel:
    """Which base and which effects; the numbers come from outside, in the order of ``parameters``."""

    base: Base
    effects: tuple[Effect, ...] = ()

    def parameters(self, facts: Facts) -> tuple[tuple[str, Parameter], ...]:
        """Return all that is searched with its full name: ``delay`` of the base, ``stiction.s`` of an effect.

        In the order of the values that the other methods take.
        """
        own = [(each.name, each) for each in self.base.parameters(facts)]
        for effect in self.effects:
            own += [(f"{effect.name}.{each.name}", each) for each in effect.parameters(facts)]
        return tuple(own)

    def position(self, op: FloatArray, values: FloatArray, facts: Facts) -> FloatArray:
        """Return the valve position, OP units, (n,), from OP without gaps, (n,).

        Valve effects act in the order of ``CHAIN``, in whichever order they were added.
        """
        position = op
        pairs = [pair for pair in self._split(values, facts) if pair[0].stage == "valve"]
        for effect, own in sorted(pairs, key=lambda pair: _place(pair[0])):
            position = cast("ValveEffect", effect).apply(position, own, facts.ts)
        return position

    def columns(self, op: FloatArray, values: FloatArray, facts: Facts) -> FloatArray:
        """Return the response of gain one, then what disturbances add but for coefficients, (n, 1 + k)."""
        process = self.base.process(values[: len(self.base.parameters(facts))])
        pairs = list(self._split(values, facts))
        for effect, own in pairs:
            if effect.stage == "process":
                process = cast("ProcessEffect[object]", effect).change(process, own)  # type: ignore[assignment]
        response = process.respond(self.position(op, values, facts), facts.ts)
        for effect, own in pairs:
            if effect.stage == "sensor":
                response = cast("SensorEffect", effect).apply(response, own, facts.ts)
        time = np.asarray(facts.ts * np.arange(len(op)), dtype=np.float64)
        added = [
            cast("DisturbanceEffect", effect).columns(time, response, own)
            for effect, own in pairs
            if effect.stage == "disturbance"
        ]
        return np.column_stack((response, *added))

    def _split(self, values: FloatArray, facts: Facts) -> list[tuple[Effect, FloatArray]]:
        at = len(self.base.parameters(facts))
        pairs = []
        for effect in self.effects:
            count = len(effect.parameters(facts))
            pairs.append((effect, values[at : at + count]))
            at += count
        return pairs


def _place(effect: Effect) -> int:
    return CHAIN.index(effect.family) if effect.family in CHAIN else len(CHAIN)
