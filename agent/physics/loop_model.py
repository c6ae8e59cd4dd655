"""A model of a loop from OP to PV: valve effects, process and its effects, sensor effects, disturbances."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, cast

import numpy as np

from agent.physics.foreign import array_of, result_of

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
    unguarded: bool = False
    """What effects of others return is not checked: the checks of their contract look at it themselves."""

    def parameters(self, facts: Facts) -> tuple[tuple[str, Parameter], ...]:
        """Return all that is searched with its full name: ``delay`` of the base, ``stiction.s`` of an effect.

        In the order of the values that the other methods take.
        """
        own = [(each.name, each) for each in self.base.parameters(facts)]
        for effect in self.effects:
            own += [(f"{effect.name}.{each.name}", each) for each in effect.parameters(facts)]
        return tuple(own)

    def layout(self, facts: Facts) -> Layout:
        """Return the model with the place of each number, for many evaluations on one record."""
        at = count = len(self.base.parameters(facts))
        pairs = []
        for effect in self.effects:
            own = len(effect.parameters(facts))
            pairs.append((effect, slice(at, at + own)))
            at += own
        return Layout(self.base, facts.ts, slice(0, count), tuple(pairs), self.unguarded)

    def position(self, op: FloatArray, values: FloatArray, facts: Facts) -> FloatArray:
        """Return the valve position, OP units, (n,), from OP without gaps, (n,)."""
        return self.layout(facts).position(op, values)

    def columns(self, op: FloatArray, values: FloatArray, facts: Facts) -> FloatArray:
        """Return the response of gain one, then the columns of the disturbances, (n, 1 + k)."""
        return self.layout(facts).columns(op, values)


@dataclass(frozen=True, slots=True)
class Layout:
    """A model on a record: which values belong to the base and which to each effect."""

    base: Base
    ts: float
    """s."""
    own: slice
    """Values of the base."""
    effects: tuple[tuple[Effect, slice], ...]
    """Each with its values."""
    unguarded: bool = False
    """As in ``LoopModel``."""

    def position(self, op: FloatArray, values: FloatArray) -> FloatArray:
        """Return the valve position, OP units, (n,), from OP without gaps, (n,).

        Valve effects act in the order of ``CHAIN``, in whichever order they were added.
        """
        position = op
        valve = [pair for pair in self.effects if pair[0].stage == "valve"]
        for effect, own in sorted(valve, key=lambda pair: _place(pair[0])):
            move = partial(cast("ValveEffect", effect).apply, position, values[own], self.ts)
            position = move() if self.unguarded else array_of(effect, len(op), move)
        return position

    def response(self, position: FloatArray, values: FloatArray) -> FloatArray:
        """Return the measured response to a valve position, OP units, for gain one, (n,)."""
        process = self.base.process(values[self.own])
        for effect, own in self.effects:
            if effect.stage == "process":
                alter = partial(cast("ProcessEffect[object]", effect).change, process, values[own])
                process = alter() if self.unguarded else result_of(effect, alter)  # type: ignore[assignment]
        response = process.respond(position, self.ts)
        for effect, own in self.effects:
            if effect.stage == "sensor":
                measure = partial(cast("SensorEffect", effect).apply, response, values[own], self.ts)
                response = measure() if self.unguarded else array_of(effect, len(position), measure)
        return response

    def columns(self, op: FloatArray, values: FloatArray) -> FloatArray:
        """Return the response of gain one, then the columns of the disturbances, (n, 1 + k)."""
        response = self.response(self.position(op, values), values)
        return np.column_stack((response, *(added for _, added in self._added(response, values))))

    def owners(self, op: FloatArray, values: FloatArray) -> tuple[str, ...]:
        """Return for each of the ``columns`` the effect that adds it; empty for the response."""
        added = self._added(np.zeros_like(op), values)
        return ("", *(effect.name for effect, columns in added for _ in range(columns.shape[1])))

    def _added(self, response: FloatArray, values: FloatArray) -> list[tuple[Effect, FloatArray]]:
        """Return each disturbance with its columns, (n, k)."""
        disturbances = [pair for pair in self.effects if pair[0].stage == "disturbance"]
        if not disturbances:
            return []
        time = np.asarray(self.ts * np.arange(len(response)), dtype=np.float64)
        found = []
        for effect, own in disturbances:
            add = partial(cast("DisturbanceEffect", effect).columns, time, response, values[own])
            columns = add() if self.unguarded else array_of(effect, len(response), add)
            found.append((effect, columns))
        return found


def _place(effect: Effect) -> int:
    return CHAIN.index(effect.family) if effect.family in CHAIN else len(CHAIN)
