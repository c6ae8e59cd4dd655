"""Backlash between actuator and plug: the valve follows only at the edges of a band."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from agent.jit import kernel
from agent.physics.effect import Facts, Parameter, Stage
from agent.physics.effects.actuator_lag import lagged
from agent.physics.effects.hysteresis import S_BY_LAW, motion_of, rest_before, start_of
from agent.physics.rows import row_of
from agent.physics.valves.damped_stem import DampedStem
from agent.units import FrictionBands

FloatArray = NDArray[np.float64]


@kernel
def backlash(command: FloatArray, width: float, x0: float) -> FloatArray:
    """Return the position (n,) of a plug that is pushed by the edges of a band ``width`` wide, OP units.

    ``x0`` is where it stands before the first sample.
    """
    position = np.empty(command.size)
    x = x0
    for t in range(command.size):
        x = min(max(x, command[t] - 0.5 * width), command[t] + 0.5 * width)
        position[t] = x
    return position


@kernel
def slack_stems(positions: FloatArray, valves: FloatArray, ts: float) -> FloatArray:
    """Return where many plugs with slack are, each behind the lag of its stem, OP units, (m, n).

    Args:
        positions: Where each is commanded to, or one row for all, OP units, (m, n) or (1, n).
        valves: Width of the band and ``start_of``, OP units, and time constant of the stem, s, (m, 3).
        ts: s.
    """
    plugs = np.empty((len(valves), positions.shape[1]))
    for i in range(len(valves)):
        command = row_of(positions, i)
        width, start, tau = valves[i, 0], valves[i, 1], valves[i, 2]
        if width == 0.0:
            plugs[i] = command
            continue
        stem = lagged(command, tau, ts)
        plugs[i] = backlash(stem, width, rest_before(command[0], width / 2, width / 2, start))
    return plugs


@dataclass(frozen=True, slots=True)
class Deadband:
    """Slack: a dead band without a slip jump, behind a stem with a lag.

    Without the stem's own lag each spike of OP would move the edges of the band, and S would be estimated
    too large.
    """

    name: str = "deadband"
    family: str = "valve_hysteresis"
    stage: Stage = "valve"
    bases: tuple[str, ...] = ()

    def parameters(self, facts: Facts) -> tuple[Parameter, ...]:
        """Return the width of the band, where the plug first moves, and the lag of the stem before it."""
        return (
            Parameter("s", "OP", 0.0, facts.op_span, null=0.0, by_law=S_BY_LAW),
            start_of(facts),
            *motion_of(facts, ("damping",)),
        )

    def apply(self, position: FloatArray, values: FloatArray, ts: float) -> FloatArray:
        """Return where the plug is."""
        return np.asarray(self.apply_all(position[np.newaxis], values[np.newaxis], ts)[0])

    def apply_all(self, positions: FloatArray, values: FloatArray, ts: float) -> FloatArray:
        """Return where each of many plugs is."""
        return slack_stems(positions, values, ts)

    def values_of(self, bands: FrictionBands, start: float, stem: DampedStem, ts: float) -> FloatArray:
        """Return the values of a band as wide as S."""
        return np.array([bands.s, start, stem.damping * ts])

    def valve_of(self, values: FloatArray, ts: float) -> tuple[FrictionBands, float, DampedStem]:
        """Return bands without a slip jump, start and the lag of the stem."""
        width, start, damping = (float(value) for value in values)
        return FrictionBands.from_s_j(width, 0.0), start, DampedStem(damping=damping / ts)
