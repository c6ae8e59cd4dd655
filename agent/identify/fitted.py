"""A candidate with its structure and its error, as a value."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from agent.identify.free_run_error import free_run_error
from agent.identify.objective import S

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agent.identify.arrays import FloatArray
    from agent.identify.problem import Problem


@dataclass(frozen=True, slots=True)
class Fitted:
    """A candidate with its structure and its sum of squares in free run, PV units squared."""

    error: float
    structure: int
    candidate: FloatArray

    @property
    def sticks(self) -> bool:
        """Whether the valve does not simply follow OP."""
        return bool(self.candidate[S] > 0)


def by_error(fits: Sequence[Fitted]) -> list[Fitted]:
    """Sort those that are possible, best first."""
    return sorted((f for f in fits if math.isfinite(f.error)), key=lambda fitted: fitted.error)


def start(candidate: FloatArray, structure: int, problem: Problem) -> Fitted:
    """Evaluate a candidate as it stands."""
    return Fitted(float(free_run_error(candidate, structure, problem)), structure, candidate)
