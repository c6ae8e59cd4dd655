"""Where in a record a model's numbers are determined: the Fisher information that each sample holds.

In free run a number is determined by the samples that its change would move. Their squares, each number's on
the scale on which it is known, are the leverages of least squares; they sum to the count of the numbers.
Source: D. Hoaglin and R. Welsch, The hat matrix in regression and ANOVA, Am. Stat. 32 (1978) 17.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from agent.workbench.objective import objective_of
from agent.workbench.projection import target_of
from agent.workbench.residual.state_dependence import directions

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray
    from agent.workbench.fit import Fit
    from agent.workbench.record import Record

DIFFERENCE = 1e-3
"""Step of derivatives, part of a parameter's range."""


def leverage_of(fitted: Fit, record: Record) -> FloatArray:
    """Return the share of each sample, (n,), sum 1; all alike where no number moves the free run.

    Level and drift are projected out: they belong to no test.
    """
    target = target_of(record, record.weight, linear=fitted.model.base.linear)
    objective = objective_of(fitted.model, record, target)
    at = objective.space.at(fitted.values)

    def run(point: FloatArray) -> FloatArray:
        return np.asarray(objective.columns(point) @ fitted.coefficients, dtype=np.float64)

    columns = [run(at)] if fitted.model.base.linear else []
    for i, place in enumerate(at.tolist()):
        ends = np.vstack((at, at))
        ends[:, i] = max(place - DIFFERENCE, 0.0), min(place + DIFFERENCE, 1.0)
        columns.append(run(ends[1]) - run(ends[0]))
    moved = np.column_stack(columns) * target.weight[:, np.newaxis]
    moved -= target.basis @ (target.basis.T @ moved)
    if not np.isfinite(moved).all() or not np.any(moved):
        return np.full(len(record), 1 / len(record))
    share = np.sum(directions(moved[:, np.any(moved, axis=0)]) ** 2, axis=1)
    return np.asarray(share / share.sum(), dtype=np.float64)
