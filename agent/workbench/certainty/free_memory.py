"""Predictions whose autoregression is free as well: what its coefficients could do says nothing of values.

In closed loop OP holds the noise, and so does what a move of a parameter does to PV: it is known from the
same samples as the autoregression, and intervals that take the latter for known are too short.
Source: L. Ljung, System Identification, 2nd ed., 9.4 and 13.4.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from agent.workbench.residual.state_dependence import directions, past_of

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray
    from agent.workbench.predictor import Predictor


def with_free_memory(predicts: Predictor, best: FloatArray) -> Predictor:
    """Return the same predictions, the residual's past projected out of everything like the nuisance.

    To first order about ``best``, (k,), where they are best: there they are the same.
    """
    target, kept = predicts.behind.target, predicts.kept
    past = past_of(predicts, best, len(predicts.noise.coefficients)) * target.weight[:, np.newaxis]
    new = directions(past - target.basis @ (target.basis.T @ past))
    freed = replace(
        target, pv=target.pv - new @ (new.T @ target.pv), basis=np.vstack((target.basis.T, new.T)).T
    )
    behind = replace(predicts.behind, target=freed)
    return replace(predicts, behind=behind, pv=freed.pv[kept], basis=freed.basis[kept])
