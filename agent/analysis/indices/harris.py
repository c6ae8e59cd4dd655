"""Harris index: how near the variance of the error is to the least that any controller could reach."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from agent.analysis.record.recording import LoopWindow

ORDER = 20
"""Terms of the prediction (Desborough and Harris use 5 to 30; more change little)."""
FEWEST = 10
"""Samples for each term that are needed."""


@dataclass(frozen=True, slots=True)
class Harris:
    """sigma_MV^2 / sigma^2 = 1 - eta (T. J. Harris, Can. J. Chem. Eng. 67:856, 1989).

    L. Desborough, T. Harris, Can. J. Chem. Eng. 70:1186 (1992): the error is predicted from what was known
    one dead time before; what cannot be predicted is the variance that no feedback removes.
    """

    name: str = "harris"
    unit: str = ""
    meaning: str = (
        "variance of the error that no controller could remove over the variance there is; 1 is best"
    )

    def of(self, window: LoopWindow, delay: float | None) -> float | None:
        """Return the index, 0 to 1; None where the dead time is not known or the record is short."""
        if delay is None or not np.isfinite(delay):
            return None
        horizon = max(1, round(delay / window.ts))
        error = window.error
        first = horizon + ORDER - 1
        if len(error) <= first:
            return None
        past = np.stack([error[first - horizon - k : len(error) - horizon - k] for k in range(ORDER)], axis=1)
        now = error[first:]
        known = np.isfinite(now) & np.isfinite(past).all(axis=1)
        if np.count_nonzero(known) < FEWEST * ORDER:
            return None
        columns = np.column_stack([np.ones(np.count_nonzero(known)), past[known]])
        total = float(np.var(now[known]))
        if total <= 0:
            return None
        answer, *_ = np.linalg.lstsq(columns, now[known], rcond=None)
        rest = now[known] - columns @ answer
        return min(float(rest @ rest) / (len(rest) - ORDER - 1) / total, 1.0)
