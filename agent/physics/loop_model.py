"""A model of a loop from OP to PV: valve effects, process and its effects, sensor effects, disturbances."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Any, Generic, NamedTuple, TypeVar, cast

import numpy as np

from agent.physics.bases.linear_process import LinearProcess, responses
from agent.physics.effect import ManyValves
from agent.physics.foreign import array_of, is_built_in, result_of
from agent.physics.rows import row_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from agent.physics.bases.base import Base, RespondingProcess
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

AnyEffect = TypeVar("AnyEffect")

CHAIN = ("valve_speed", "extra_lag", "valve_hysteresis", "valve_limits", "valve_characteristic")
"""Families of valve effects from the controller's side to the flow's; one that is not here acts last."""
STAGES = ("valve", "process", "sensor", "disturbance")
"""In which effects act, from OP to PV."""

SMALL = 1e-3
"""Part of the span of the valve's moves by which it is moved for a derivative."""
TINY = np.finfo(float).tiny


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
        facts = facts if self.base.linear else replace(facts, response="PV")
        own = [(each.name, each) for each in self.base.parameters(facts)]
        for effect in self.effects:
            own += [(f"{effect.name}.{each.name}", each) for each in effect.parameters(facts)]
        return tuple(own)

    def layout(self, facts: Facts) -> Layout:
        """Return the model with the place of each number, for many evaluations on one record."""
        at = count = len(self.base.parameters(facts))
        placed: dict[str, list[PlacedEffect[Effect]]] = {each: [] for each in STAGES}
        for effect in self.effects:
            own = slice(at, at + len(effect.parameters(facts)))
            placed[effect.stage].append(
                PlacedEffect(
                    effect,
                    own,
                    not (self.unguarded or is_built_in(effect)),
                    is_built_in(effect) and isinstance(effect, ManyValves),
                )
            )
            at = own.stop
        placed["valve"].sort(key=lambda each: _place(each.effect))
        return Layout(self.base, facts.ts, slice(0, count), *(cast("Any", placed[each]) for each in STAGES))

    def position(self, op: FloatArray, values: FloatArray, facts: Facts) -> FloatArray:
        """Return the valve position, OP units, (n,), from OP without gaps, (n,)."""
        return self.layout(facts).position(op, values)

    def columns(self, op: FloatArray, values: FloatArray, facts: Facts) -> FloatArray:
        """Return the response of gain one, then the columns of the disturbances, (n, 1 + k)."""
        return self.layout(facts).columns(op, values)


class PlacedEffect(NamedTuple, Generic[AnyEffect]):
    """An effect in a layout."""

    effect: AnyEffect
    own: slice
    """Its values."""
    guarded: bool
    """Whether what it returns is checked: somebody else wrote it."""
    many: bool
    """Whether it moves many valves at once."""


@dataclass(frozen=True, slots=True)
class Layout:
    """A model on a record: which values belong to the base and which to each effect.

    All that does not depend on the values is settled before: a search evaluates it a hundred thousand times.
    """

    base: Base
    ts: float
    """s."""
    own: slice
    """Values of the base."""
    valve: Sequence[PlacedEffect[ValveEffect]]
    """In the order of ``CHAIN``, in whichever order they were added."""
    process: Sequence[PlacedEffect[ProcessEffect[object]]]
    sensor: Sequence[PlacedEffect[SensorEffect]]
    disturbances: Sequence[PlacedEffect[DisturbanceEffect]]

    def position(self, op: FloatArray, values: FloatArray) -> FloatArray:
        """Return the valve position, OP units, (n,), from OP without gaps, (n,)."""
        return np.asarray(self._positions(op, values[np.newaxis])[0])

    def _positions(self, op: FloatArray, values: FloatArray) -> FloatArray:
        """Return the positions of many valves, (m, n), of values (m, k); one row where all are OP, (1, n)."""
        positions = op[np.newaxis]
        for effect, own, guarded, many in self.valve:
            if many:
                positions = cast("ManyValves", effect).apply_all(positions, values[:, own], self.ts)
                continue
            pairs = ((row_of(positions, i), each) for i, each in enumerate(values[:, own]))
            moves = (partial(effect.apply, *pair, self.ts) for pair in pairs)
            positions = np.array([array_of(effect, len(op), move) if guarded else move() for move in moves])
        return positions

    def response(self, position: FloatArray, values: FloatArray) -> FloatArray:
        """Return the measured response to a valve position, OP units, for gain one, (n,)."""
        process = self.process_of(values)
        response = process.respond(position, self.ts)
        if not self.sensor:
            return response
        # A curve over PV lies at levels of OP, wherever the response is counted from.
        level = process.counted_from(position) if isinstance(process, LinearProcess) else 0.0
        response = response + level
        for effect, own, guarded, _ in self.sensor:
            if guarded:
                measure = partial(effect.apply, response, values[own], self.ts)
                response = array_of(effect, len(position), measure)
            else:
                response = effect.apply(response, values[own], self.ts)
        return response - level

    def process_of(self, values: FloatArray) -> RespondingProcess:
        """Return the process of the base as the effects have changed it."""
        process = self.base.process(values[self.own])
        for altering, own, guarded, _ in self.process:
            alter = partial(altering.change, process, values[own])
            process = cast("RespondingProcess", result_of(altering, alter) if guarded else alter())
        return process

    def answers(self, position: FloatArray, moves: FloatArray, values: FloatArray) -> FloatArray:
        """Return what the response does more for small moves of the valve, (n, k), its unit a unit of move.

        ``moves``: (n, k). Of a linear process the response to them; behind a law of a balance, behind losses
        or friction of an effect, or where a sensor may have a curve, its derivative along ``position``.
        """
        process = self.process_of(values)
        if isinstance(process, LinearProcess) and process.superposes and not self.sensor:
            return np.column_stack([self.response(each, values) for each in moves.T])
        there, span = self.response(position, values), float(np.ptp(position))
        found = np.zeros_like(moves)
        for i, move in enumerate(moves.T):
            part = SMALL * span / max(float(np.max(np.abs(move))), TINY)
            if part > 0.0:
                found[:, i] = (self.response(position + part * move, values) - there) / part
        return found

    def columns(self, op: FloatArray, values: FloatArray) -> FloatArray:
        """Return the response of gain one, then the columns of the disturbances, (n, 1 + k)."""
        return np.asarray(self.rows(op, values[np.newaxis])[0].T)

    def rows(self, op: FloatArray, values: FloatArray) -> FloatArray:
        """Return the same of many values, (m, k), each column a row, (m, 1 + k, n).

        A search needs most of its points several at a time, and around one numpy and Python take as long as
        the work. Sums over samples are many, and run along a row.
        """
        answers = self._responses(self._positions(op, values), values)
        if not self.disturbances:
            return answers[:, np.newaxis]
        found = []
        for response, own in zip(answers, values, strict=True):
            added = (columns.T for _, columns in self._added(response, own))
            found.append(np.concatenate((response[np.newaxis], *added)))
        return np.array(found)

    def _responses(self, positions: FloatArray, values: FloatArray) -> FloatArray:
        """Return the responses to many positions, (m, n) or one row for all, of values (m, k)."""
        if not self.sensor and self.base.linear:
            return responses([self.process_of(own) for own in values], positions, self.ts)
        return np.array([self.response(row_of(positions, i), own) for i, own in enumerate(values)])

    def owners(self, op: FloatArray, values: FloatArray) -> tuple[str, ...]:
        """Return for each of the ``columns`` the effect that adds it; empty for the response."""
        added = self._added(np.zeros_like(op), values)
        return ("", *(effect.name for effect, columns in added for _ in range(columns.shape[1])))

    def _added(self, response: FloatArray, values: FloatArray) -> list[tuple[Effect, FloatArray]]:
        """Return each disturbance with its columns, (n, k)."""
        if not self.disturbances:
            return []
        time = np.asarray(self.ts * np.arange(len(response)), dtype=np.float64)
        found: list[tuple[Effect, FloatArray]] = []
        for effect, own, guarded, _ in self.disturbances:
            add = partial(effect.columns, time, response, values[own])
            found.append((effect, array_of(effect, len(response), add) if guarded else add()))
        return found


def _place(effect: Effect) -> int:
    return CHAIN.index(effect.family) if effect.family in CHAIN else len(CHAIN)
