"""Shared by friction and slack: first rest position of the stem, its motion, parameter values from bands."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from agent.jit import kernel
from agent.physics.effect import Facts, Parameter, ValveEffect
from agent.physics.rows import row_of
from agent.physics.valves.damped_stem import (
    DAMPING,
    GIVE,
    REST,
    SUPPLY,
    DampedStem,
    damped_stem_by_direction,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agent.units import FrictionBands

    FloatArray = NDArray[np.float64]


S_BY_LAW, J_BY_LAW = 0.10, 0.33
"""``Parameter.by_law`` of S, and of the difference of static and kinetic friction. A Stribeck curve and a
stem of bristles move alike with bands that differ so much: nine in ten of 13 loops of
``simulators.draws.hidden_effects``, seeds 7100 to 7113, are within both (12 and 12 of 13)."""
MOTION = ("damping", "supply", "rest", "give")
"""Parameters of ``motion_of``."""
STIFF = MOTION[:3]
"""Those of a stem whose bristles do not give."""


@runtime_checkable
class HysteresisEffect(ValveEffect, Protocol):
    """A valve whose position depends on the direction of OP; its error over S and J has a narrow minimum."""

    def values_of(self, bands: FrictionBands, start: float, stem: DampedStem, ts: float) -> FloatArray:
        """Return the values of this effect, in their order, nearest to a valve with ``bands`` and ``stem``.

        ``start`` is as in ``start_of``, ``ts`` the time between samples, s.
        """
        ...

    def valve_of(self, values: FloatArray, ts: float) -> tuple[FrictionBands, float, DampedStem]:
        """Return bands, start and stem of the valve with the same bands in both directions that is nearest.

        What ``values_of`` takes, from what it returns.
        """
        ...


def start_of(facts: Facts) -> Parameter:
    """OP at the first slip less OP at the first sample; below 0 that slip is downward.

    The position at rest is not used: with this parameter S and J may change without moving the first slip, so
    that a search stays in its basin (docs/methods/free_run.md).
    """
    return Parameter("start", "OP", -facts.op_span, facts.op_span, of_record=True)


@kernel
def rest_before(op: float, f_s_up: float, f_s_down: float, start: float) -> float:
    """Return where a stem rests before the first sample, OP units; friction holds it there.

    Args:
        op: First OP, OP units.
        f_s_up: Static friction against a rising stem, OP units.
        f_s_down: Static friction against a falling stem, OP units.
        start: As in ``start_of``, OP units.
    """
    rest = op + start - f_s_up if start >= 0.0 else op + start + f_s_down
    return min(max(rest, op - f_s_up), op + f_s_down)


@kernel
def moved_stems(
    positions: NDArray[np.float64], valves: NDArray[np.float64], motion: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the positions of many damped stems, OP units, (m, n); one without friction follows at once.

    Args:
        positions: Where each is commanded to, or one row for all, OP units, (m, n) or (1, n).
        valves: Static friction against a rising stem and against a falling one, kinetic friction, and
            ``start_of``, OP units, (4, m).
        motion: Damping and supply, samples, rest and give, as ``damped_stem`` takes them, (m, 4).
    """
    moved = np.empty((valves.shape[1], positions.shape[1]))
    for i in range(valves.shape[1]):
        command = row_of(positions, i)
        f_s_up, f_s_down, f_d, start = valves[0, i], valves[1, i], valves[2, i], valves[3, i]
        if f_s_up == 0.0 and f_s_down == 0.0:
            moved[i] = command
            continue
        x0 = rest_before(command[0], f_s_up, f_s_down, start)
        damping, supply, rest, give = motion[i, 0], motion[i, 1], motion[i, 2], motion[i, 3]
        moved[i] = damped_stem_by_direction(command, f_s_up, f_s_down, f_d, x0, damping, supply, rest, give)
    return moved


def motion_of(facts: Facts, names: Sequence[str] = MOTION) -> tuple[Parameter, ...]:
    """Motion of a stem once it slips: its damping, its supply of air, where it comes to rest, its bristles.

    They are not known beforehand, and with the motion of another stem a search finds another S and J.
    ``names``: which of them.
    """
    ranges = zip(
        MOTION,
        ("s", "s", "1", "1"),
        (DAMPING, SUPPLY, REST, GIVE),
        (facts.ts, facts.ts, 1.0, 1.0),
        strict=True,
    )
    return tuple(
        Parameter(name, unit, low * scale, high * scale, log=True, natural=True)
        for name, unit, (low, high), scale in ranges
        if name in names
    )


def motions(values: FloatArray, ts: float) -> FloatArray:
    """Return motions as ``moved_stems`` takes them, (m, 4), of values of ``motion_of``, (m, 4) or (m, 3)."""
    found = np.zeros((len(values), len(MOTION)))
    found[:, : values.shape[1]] = values
    found[:, :2] /= ts
    found[found[:, 3] <= GIVE[0], 3] = 0.0
    return found


def moving(values: FloatArray, ts: float) -> DampedStem:
    """Return the stem of the values of ``motion_of``, (4,), or of a stiff one, (3,)."""
    damping, supply, rest, give = motions(values[np.newaxis], ts)[0].tolist()
    return DampedStem(damping=damping, supply=supply, rest=rest, give=give)


def motion_values(stem: DampedStem, ts: float) -> FloatArray:
    """Return the values (4,) of ``motion_of`` for a stem."""
    return np.array([stem.damping * ts, stem.supply * ts, stem.rest, max(stem.give, GIVE[0])])
