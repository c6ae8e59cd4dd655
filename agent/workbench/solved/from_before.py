"""What PV still answers to OP before a recording, which nobody recorded.

A recording that is cut out of a longer one begins while the process moves: a mass swings, a vessel fills.
That is the response to positions of the valve before, and it is linear in them.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from agent.workbench.checks.unnamed import LINEAR

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray
    from agent.physics.loop_model import LoopModel
    from agent.workbench.fit import Fit
    from agent.workbench.record import Record

PARTS = 10
"""Parts into which OP before the recording is divided, each half as long as the one before it."""


def from_before(model: LoopModel, values: FloatArray, record: Record) -> FloatArray:
    """Return what PV still answers to moves of OP before a recording, of height one, PV over gain, (n, k).

    They go through the lags of the valve, and through no friction: where the valve was is not known either.

    Args:
        model: On a linear base.
        values: Of its parameters, own units, (j,).
        record: The recording, n samples.
    """
    layout, longest = model.layout(record.facts), len(record)
    edges = np.unique([0, *(longest * 0.5 ** np.arange(PARTS)).round().astype(int)])
    ago = longest - np.arange(longest + len(record))[:, np.newaxis]
    moves = ((ago > edges[:-1]) & (ago <= edges[1:])).astype(np.float64)
    for effect, own, *_ in layout.valve:
        if effect.family in LINEAR:
            moves = np.column_stack([effect.apply(each, values[own], layout.ts) for each in moves.T])
    position = layout.position(record.op, values)
    before = np.concatenate((np.full(longest, position[0]), position))
    return layout.answers(before, moves, values)[longest:]


def begun_in_motion(fitted: Fit, record: Record) -> Record:
    """Return a record with what its base still answers to OP before it, as far as that would be seen.

    Seen is what a move of OP by its range leaves above the deviation of the residual.
    """
    counts = record.weight > 0
    columns = from_before(fitted.model, fitted.values, record)
    columns = columns - columns[counts].mean(axis=0)  # of an integrator they are levels
    moved = abs(float(fitted.coefficients[0])) * (record.facts.op_high - record.facts.op_low)
    _, size, turned = np.linalg.svd(columns[counts] * moved, full_matrices=False)
    deviation = np.sqrt(fitted.error / max(int(np.count_nonzero(counts)), 1))
    seen = size > max(deviation, np.finfo(float).tiny)
    if not seen.any():
        return record
    start = columns @ turned[seen].T * (moved / size[seen])
    return replace(record, start=start * np.sqrt(len(record)))
