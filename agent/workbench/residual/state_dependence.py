"""Test whether the response to OP depends on level, speed, time or direction in a way that the model lacks.

A score test (Rao 1948; also called Lagrange multiplier test) of state-dependent parameters: gain and offset
of the valve may differ between the parts of an axis, or more of OP's past may act; the test is whether the
innovations fall by more than so many free numbers explain. Nothing is refitted; the effect of a change of any
parameter, of the level or of the autoregression is projected out first. It is valid in closed loop because
innovations do not depend on earlier OP (``innovations.py``). It detects a change of gain or a stop that no
bin mean shows, because each sample of the response contributes.
Source: reference ``missing_effect.md`` section 4, step 10; P. Young, State-dependent parameter models (2000).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from scipy import stats

from agent.workbench.residual.axes import physical_axes

if TYPE_CHECKING:
    from collections.abc import Mapping

    from agent.analysis.record.recording import FloatArray
    from agent.workbench.predictor import Predictor
    from agent.workbench.record import Record

    Predictions = tuple[Predictor, FloatArray]

PARTS = 5
"""Of level, speed and time."""
TRAVELS = 4
"""Parts of the travel since OP reversed, in each direction."""
PAST = (1, 2, 3, 4, 6, 8, 11, 15, 20, 27, 36, 50)
"""Samples of delay at which OP itself may act."""
MEMORY = 25
"""Lags of the residual that may explain it: a small error of the autoregression is no missing effect."""
DECAYS = (0.06, 0.12, 0.25, 0.5, 1.0)
"""Time constants of a transient of PV at the start of the record, dominant periods."""
DOUBTED = 20.0
"""Multiplies p, which is too small where an axis has few strokes: of 200 loops with a complete model, of
tests/unit/workbench/test_closed_loop.py, p was below 0.05 on 12 %, below 0.05 / 20 on 2 %."""
LEVEL = 0.05
"""The loop depends on an axis, and a residual follows one, where p is below it."""
MOST_LEFT = 0.4
"""Largest part of the excess that may remain with the true effect: on loops 6000 to 6006 of
``simulators.draws.hidden_effects`` true ones leave up to 0.35."""
PLAINLY, PART_LEFT = 1e-6, 0.1
"""Nor may this part of the excess remain with so small a p: true effects of the 76 loops of seeds 5334 to
5347 whose base fails have p = 6e-4 at least, a stop in place of a nonlinear trim (5344) leaves 0.22 with
3e-41."""
INDEPENDENT = 1e-3
"""Singular value, of columns of length one, from which on a direction counts as independent."""


@dataclass(frozen=True, slots=True)
class Dependence:
    """Dependence of the loop on an axis beyond the model."""

    p: float
    """That a complete model shows as much on any of the axes."""
    excess: float
    """Squares of the innovations that it explains, less those by chance, PV units squared. Not relative to
    the residual, which falls with each effect, so that in the end a small excess would look large."""


def state_dependence(predicts: Predictor, best: FloatArray) -> dict[str, Dependence]:
    """Return the dependence on each axis.

    Args:
        predicts: Of a model.
        best: The point of the unit cube where its predictions are best, (k,).

    Returns:
        Of ``op_level``, ``op_rate`` (where missing dynamics show, too), ``travel_since_reversal``, ``time``.
    """
    left = predicts.residual(best)
    known = _known(predicts, best)
    left = left - known @ (known.T @ left)
    found = {
        axis: _score(predicts, each, known, left) for axis, each in _alternatives(predicts, best).items()
    }
    return {axis: replace(each, p=min(1.0, len(found) * each.p)) for axis, each in found.items()}


def failing(found: Mapping[str, Dependence]) -> set[str]:
    """Return the axes on which a model fails."""
    return {axis for axis, each in found.items() if DOUBTED * each.p < LEVEL}


def fails(found: Mapping[str, Dependence]) -> bool:
    """Return whether a model fails on any axis."""
    return bool(failing(found))


def still_fails(
    before: Mapping[str, Dependence], after: Mapping[str, Dependence], removed: float
) -> set[str]:
    """Return the axes on which a larger model fails by much of what the smaller one failed by.

    By much of it, or by a part with a small p; empty where the smaller model cannot be tested, or does not
    fail. The smaller one failed by the most excess on an axis, or by what the larger one removes, if that is
    more: behind a curve of the sensor the larger one sees on its axes what the smaller one does not.

    Args:
        before: Of the smaller model.
        after: Of the larger one.
        removed: By which the larger one lowers the squares of the innovations, PV units squared.
    """
    if not before or not after:
        return set()
    most = max(before.values(), key=lambda each: each.excess)
    if DOUBTED * most.p >= LEVEL:
        return set()
    failed = max(most.excess, removed)
    return {
        axis
        for axis, each in after.items()
        if (DOUBTED * each.p < LEVEL and each.excess >= MOST_LEFT * failed)
        or (each.p < PLAINLY and each.excess >= PART_LEFT * failed)
    }


def removed_by(smaller: Predictions | None, larger: Predictions | None) -> float:
    """Return by how much a larger model lowers the squares of the innovations, each at its best."""
    if smaller is None or larger is None:
        return 0.0
    return smaller[0].error(smaller[1]) - larger[0].error(larger[1])


def _known(predicts: Predictor, best: FloatArray) -> FloatArray:
    """Return orthonormal columns of all that the model may still explain, (m, q)."""
    record, kept = predicts.objective.record, predicts.kept
    past = past_of(predicts, best, MEMORY)[kept]
    own = np.column_stack((predicts.solved_for(predicts.objective.columns(best)), left_of_start(record)))
    white = predicts.noise.filtered(own)[kept]
    return directions(np.column_stack((predicts.derivative(best), white, predicts.basis, past)))


def past_of(predicts: Predictor, best: FloatArray, lags: int) -> FloatArray:
    """Return the free run's residual one sample before and more, PV units, (n, lags); zero where unknown."""
    residual = np.nan_to_num(predicts.left(best))
    return np.column_stack([_delayed(residual, lag) for lag in range(1, lags + 1)])


def left_of_start(record: Record) -> FloatArray:
    """Return columns of the transient of PV at the start of the record, (n, k), of any unit."""
    time = np.arange(len(record))[:, np.newaxis]
    return np.asarray(np.exp(-time / (np.array(DECAYS) * record.period)), dtype=np.float64)


def _alternatives(predicts: Predictor, best: FloatArray) -> dict[str, FloatArray]:
    """Return for each axis the tested additional responses of PV, PV units but for a factor, (n, k)."""
    objective = predicts.objective
    record, layout, values = objective.record, objective.layout, objective.space.values(best)
    position = layout.position(record.op, values)
    moves = position - position.mean()

    def response(inputs: FloatArray) -> FloatArray:
        return layout.answers(position, inputs, values)

    def affine(parts: FloatArray) -> FloatArray:
        return np.hstack((response(parts), response(parts * moves[:, np.newaxis])))

    axes = physical_axes(record.op, record.facts.ts, record.period)
    travel, direction = axes["travel_since_reversal"], axes["direction"]
    strokes = [_parts(np.where(direction == way, travel, np.nan), TRAVELS) for way in (-1.0, 1.0)]
    past = np.column_stack([_delayed(moves, lag) for lag in PAST])
    return {
        "op_level": affine(_parts(axes["op_level"], PARTS)),
        "op_rate": np.hstack((affine(_parts(axes["op_rate"], PARTS)), past)),
        "travel_since_reversal": response(np.hstack(strokes)),
        "time": response(moves[:, np.newaxis]) * _parts(axes["time"], PARTS),
    }


def _parts(axis: FloatArray, count: int) -> FloatArray:
    """Return which of ``count`` parts of equal size each sample is in, 1 or 0, (n, count)."""
    known = np.isfinite(axis)
    if not known.any():
        return np.zeros((len(axis), count))
    inner = np.quantile(axis[known], np.arange(1, count) / count)
    number = np.where(known, np.searchsorted(inner, axis, side="right"), -1)
    return np.asarray(number[:, np.newaxis] == np.arange(count), dtype=np.float64)


def _score(predicts: Predictor, columns: FloatArray, known: FloatArray, left: FloatArray) -> Dependence:
    """Return the F test that ``columns`` (n, k) explain nothing of the residual ``left``, (m,)."""
    white = predicts.noise.filtered(columns)[predicts.kept]
    length = np.linalg.norm(white, axis=0)
    white = white[:, length > 0] / length[length > 0]
    new = directions(white - known @ (known.T @ white), scaled=True)
    count = new.shape[1]
    freedom = len(left) - known.shape[1] - count
    if count == 0 or freedom < 1:
        return Dependence(1.0, 0.0)
    explained = float(np.sum((new.T @ left) ** 2))
    rest = max(float(left @ left) - explained, np.finfo(float).tiny)
    by_chance = count * rest / freedom
    return Dependence(float(stats.f.sf(explained / by_chance, count, freedom)), explained - by_chance)


def directions(columns: FloatArray, *, scaled: bool = False) -> FloatArray:
    """Return an orthonormal basis of columns (m, k), of length one first unless they are ``scaled``."""
    if not scaled:
        length = np.linalg.norm(columns, axis=0)
        columns = columns[:, length > 0] / length[length > 0]
    basis, sizes, _ = np.linalg.svd(columns, full_matrices=False)
    return np.asarray(basis[:, sizes > INDEPENDENT], dtype=np.float64)


def _delayed(values: FloatArray, lag: int) -> FloatArray:
    return np.concatenate((np.zeros(lag), values[:-lag]))
