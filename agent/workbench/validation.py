"""A fitted model on another recording of the same loop, which no fit used."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from scipy.optimize import minimize

from agent.workbench.inputs.measured_input import MeasuredInput, elsewhere
from agent.workbench.nuisance import nuisance
from agent.workbench.search import hypercube
from agent.workbench.solved.from_before import from_before
from agent.workbench.space import space_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from agent.analysis.record.recording import FloatArray
    from agent.workbench.fit import Fit
    from agent.workbench.record import Record

OPENING = 0.1
"""First part of the other recording, from which its initial state is estimated, at least two periods."""
SCAN = 100
"""Starts that are tried."""


def rmse_on(fitted: Fit, other: Record) -> float:
    """Return the error of ``free_run_on``, PV units."""
    counts = other.weight > 0
    return float(np.sqrt(np.mean((other.pv - free_run_on(fitted, other))[counts] ** 2)))


def free_run_on(fitted: Fit, other: Record) -> FloatArray:
    """Return PV of another recording in free run from its OP, PV units, (n,).

    All that belongs to the loop is kept. The initial state is estimated from the opening of the recording, or
    of a linear base solved for as positions of the valve before it; level, drift and the amplitudes of
    disturbances belong to a recording and are fitted to all of it, but for the gains of measured inputs.

    Raises:
        ValueError: The other recording lacks an input of the model.
    """
    fitted = replace(fitted, model=elsewhere(fitted.model))
    values = _started(fitted, other)
    own = None
    if fitted.model.base.linear:
        own = np.column_stack((nuisance(len(other), other.period), from_before(fitted.model, values, other)))
    return _run(fitted, other, values, own, other.weight > 0)


def of_loop(fitted: Fit, record: Record) -> NDArray[np.bool_]:
    """Return which coefficients, (c,), belong to the loop: those of the response and of measured inputs."""
    inputs = {each.name for each in fitted.model.effects if isinstance(each, MeasuredInput)}
    owners = fitted.model.layout(record.facts).owners(record.op, fitted.values)
    return np.array([owner == "" or owner in inputs for owner in owners], dtype=np.bool_)


def _started(fitted: Fit, other: Record) -> FloatArray:
    """Return the values with those of ``other`` where they belong to a record."""
    space = space_of(fitted.model, other.facts)
    of_record = np.array([each.of_record for each in space.parameters], dtype=bool)
    values = fitted.values.copy()
    if not of_record.any():
        return values
    opening = (other.weight > 0) & (np.arange(len(other)) < max(OPENING * len(other), 2 * other.period))
    level = np.ones((len(other), 1)) if fitted.model.base.linear else None

    def placed(at: FloatArray) -> FloatArray:
        within = np.zeros(len(space))
        within[of_record] = at
        return np.where(of_record, space.values(within), values)

    def error(at: FloatArray) -> float:
        missed = (other.pv - _run(fitted, other, placed(at), level, opening))[opening]
        return float(missed @ missed)

    starts = hypercube(SCAN, int(of_record.sum()))
    best = starts[np.argmin([error(at) for at in starts])]
    found = minimize(error, best, method="Nelder-Mead", bounds=[(0.0, 1.0)] * len(best))
    return placed(found.x)


def _run(
    fitted: Fit, other: Record, values: FloatArray, drift: FloatArray | None, counts: NDArray[np.bool_]
) -> FloatArray:
    """Return the free run; drift and disturbances are fitted to the samples that count."""
    columns = fitted.model.columns(other.op, values, other.facts)
    kept = of_loop(fitted, other)
    ran = columns[:, kept] @ fitted.coefficients[kept]
    own = columns[:, ~kept] if drift is None else np.column_stack((columns[:, ~kept], drift))
    if not own.shape[1]:
        return np.asarray(ran, dtype=np.float64)
    amounts, *_ = np.linalg.lstsq(own[counts], (other.pv - ran)[counts], rcond=None)
    return np.asarray(ran + own @ amounts, dtype=np.float64)
