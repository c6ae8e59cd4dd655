"""What OP did in a record, and which families of effects need more of it than that."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.record.reversals import NOISES, op_noise, significant_reversals

if TYPE_CHECKING:
    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]

FEW_LEVELS = 2
"""With so many levels of OP every curve between them is a straight line: another gain."""
SAME_LEVEL = 0.01
"""Part of OP's span within which two values are one level, at least."""
MANY_TURNS = 2
"""Of OP, from which on a stem that sticks comes back to where it was."""


@dataclass(frozen=True, slots=True)
class Excitation:
    """What OP did, beyond its noise."""

    turns: int
    """How often OP turned back."""
    levels: int
    """How many levels OP has, at most ``FEW_LEVELS`` + 1 are counted."""


def excitation_of(op: FloatArray) -> Excitation:
    """Return what OP (n,), OP units, no NaN, did in a record."""
    span, noise = float(np.ptp(op)), op_noise(op)
    turns = significant_reversals(op)
    return Excitation(turns, _levels(op, max(NOISES * noise, SAME_LEVEL * span)))


def not_excited(family: str, did: Excitation) -> str | None:
    """Return in words why a family of effects does nothing that the record could show; None where it may.

    A stem that sticks is seen where OP turns back: it does not come back to where it was. OP that goes on
    between two levels leaves it two positions, and a stop, a curve and a band are all another gain.
    """
    if family == "valve_hysteresis" and did.turns < MANY_TURNS:
        return None if did.turns else "OP never turns back"
    if did.levels > FEW_LEVELS:
        return None
    if family in {"valve_characteristic", "valve_limits", "valve_hysteresis"}:
        return f"OP has only {did.levels} levels, and between two levels every valve is another gain"
    return None


def is_untried_rival(family: str, did: Excitation) -> bool:
    """Return whether a family that was not tried may move PV, so that another cause looks alike.

    After one turn of OP a stem that sticks is off where it was before, as after a step of the load. What OP
    does not excite at all moves nothing.
    """
    return family == "valve_hysteresis" and 0 < did.turns < MANY_TURNS


def _levels(op: FloatArray, apart: float) -> int:
    """Return how many levels OP has that are ``apart``, at most one more than ``FEW_LEVELS``."""
    left, count = op, 0
    while left.size and count <= FEW_LEVELS:
        count += 1
        left = left[np.abs(left - left[0]) > apart]
    return count
