"""Least squares for what enters linearly: gain, nuisance and the amplitudes of disturbances.

Variable projection (Golub and Pereyra 1973): the search moves the rest only (design, fact 4).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from agent.workbench.normal_equations import least_errors, left_of, lowered_by, residuals_behind
from agent.workbench.nuisance import nuisance_of

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray
    from agent.workbench.record import Record

VANISHES = 1e-9
"""Share of a column's squares outside the nuisance below which the column counts as zero."""


@dataclass(frozen=True, slots=True)
class ProjectedPv:
    """PV of the samples that count, the nuisance projected out."""

    weight: FloatArray
    """1 or 0, (n,)."""
    pv: FloatArray
    """Zero where the weight is, PV units, (n,)."""
    basis: FloatArray
    """Orthonormal columns of the nuisance on the samples that count, (n, q), column by column in memory."""
    gain_sign: int
    """+1 or -1; 0 where both are possible."""
    fixed_gain: bool
    """The response is PV itself: it has no gain and there is no nuisance."""

    @property
    def count(self) -> int:
        """Samples that count."""
        return int(self.weight.sum())


@dataclass(frozen=True, slots=True)
class Solved:
    """The best coefficients of given columns."""

    error: float
    """Sum of squares, PV units squared; infinite where a column is."""
    coefficients: FloatArray
    """Of the response, then of the disturbances, (1 + k,)."""
    residual: FloatArray
    """Zero where the weight is, PV units, (n,)."""


def target_of(record: Record, weight: FloatArray, *, linear: bool) -> ProjectedPv:
    """Return what models of ``record`` are fitted to; ``weight`` (n,) says which samples count."""
    if not linear:
        return target_itself(record.pv, weight, record.facts.gain_sign)
    return target_behind(record.pv, nuisance_of(record), weight, record.facts.gain_sign)


def target_itself(pv: FloatArray, weight: FloatArray, gain_sign: int) -> ProjectedPv:
    """Return PV (n,) of the samples that count, for a response that is PV itself, level and all."""
    return ProjectedPv(weight, pv * weight, np.empty((0, len(pv))).T, gain_sign, fixed_gain=True)


def target_behind(pv: FloatArray, drift: FloatArray, weight: FloatArray, gain_sign: int) -> ProjectedPv:
    """Return PV (n,) of the samples that count, level and drift, columns (n, k), projected out."""
    pv, columns = pv * weight, drift * weight[:, None]
    scale, rotation = np.linalg.eigh(columns.T @ columns)
    there = scale > VANISHES * scale[-1]
    basis = np.asfortranarray(columns @ (rotation[:, there] / np.sqrt(scale[there])))
    return ProjectedPv(weight, pv - basis @ (basis.T @ pv), basis, gain_sign, fixed_gain=False)


def solve(columns: FloatArray, target: ProjectedPv) -> Solved:
    """Return the coefficients of ``columns`` (n, 1 + k), the response first, that leave the least squares."""
    if not target.fixed_gain:
        return _with_gain(columns, target)
    if not np.isfinite(columns).all():
        return Solved(np.inf, np.zeros(columns.shape[1]), target.pv)
    if columns.shape[1] == 1 and not target.basis.size:  # nothing to solve for, as in most calls
        residual = target.pv - columns[:, 0] * target.weight
        return Solved(float(residual @ residual), np.ones(1), residual)
    free = columns * target.weight[:, None]
    squares = np.einsum("ij,ij->j", free, free)
    free = free - target.basis @ (target.basis.T @ free)
    rest = target.pv - free[:, 0]
    coefficients = np.concatenate(([1.0], _least_squares(free[:, 1:], rest, squares[1:])))
    residual = target.pv - free @ coefficients
    return Solved(float(residual @ residual), coefficients, residual)


def _with_gain(columns: FloatArray, target: ProjectedPv) -> Solved:
    """Return ``solve`` of a response that has a gain, by sums of products."""
    rows, basis = np.ascontiguousarray(columns.T), target.basis.T
    free, outside, coefficients, lowered = lowered_by(
        rows, target.weight, basis, target.pv, target.gain_sign, VANISHES
    )
    if lowered == -np.inf:
        return Solved(np.inf, coefficients, target.pv)
    residual = left_of(target.pv, free, coefficients, basis, outside)
    return Solved(float(residual @ residual), coefficients, residual)


def errors_of(rows: FloatArray, target: ProjectedPv) -> FloatArray:
    """Return the errors, PV units squared, (m,), of many models; the columns of each are rows (m, 1 + k, n).

    Of a response that has a gain by sums of products alone, right to about 1e-12 of the squares of PV.
    """
    if target.fixed_gain:
        return np.array([solve(each.T, target).error for each in rows])
    rows = np.ascontiguousarray(rows)
    return least_errors(rows, target.weight, target.basis.T, target.pv, target.gain_sign, VANISHES)


def residuals_of(rows: FloatArray, target: ProjectedPv) -> FloatArray:
    """Return the residuals, PV units, (m, n), of many models as ``errors_of`` takes them."""
    if target.fixed_gain:
        return np.array([solve(each.T, target).residual for each in rows])
    rows = np.ascontiguousarray(rows)
    return residuals_behind(rows, target.weight, target.basis.T, target.pv, target.gain_sign, VANISHES)


def _least_squares(columns: FloatArray, values: FloatArray, squares: FloatArray) -> FloatArray:
    """Solve by normal equations of columns of length one; what vanished in the nuisance gets zero.

    A ridge of ``VANISHES`` shares between columns that are the same.
    """
    coefficients = np.zeros(columns.shape[1])
    lengths = np.sqrt(np.einsum("ij,ij->j", columns, columns))
    there = lengths > np.sqrt(VANISHES * squares)
    unit = columns[:, there] / lengths[there]
    gram = unit.T @ unit + VANISHES * np.eye(unit.shape[1])
    coefficients[there] = np.linalg.solve(gram, unit.T @ values) / lengths[there]
    return coefficients


def nuisance_part(record: Record, explained: FloatArray, weight: FloatArray) -> FloatArray:
    """Return level and drift, PV units, (n,), that are left of PV beside what is ``explained``, (n,)."""
    columns = nuisance_of(record)
    counts = weight > 0
    coefficients, *_ = np.linalg.lstsq(columns[counts], (record.pv - explained)[counts], rcond=VANISHES)
    return np.asarray(columns @ coefficients, dtype=np.float64)
