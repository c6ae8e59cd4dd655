"""The sign of the process gain, read from the controller's own arithmetic."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from agent.analysis.recording import LoopWindow

LEAST_EXPLAINED = 0.3
"""Share of the OP increments that the PI law must explain before its sign is believed."""


def process_gain_sign(window: LoopWindow) -> int:
    """Return +1 (reverse acting controller), -1 (direct acting), or 0 where it cannot be told.

    Negative feedback makes the process gain and the controller gain agree in sign, and the controller gain is
    in the record: OP is computed from the error by dOP = K_c (de + Ts/T_i e), so a regression of the OP
    increments on de and e gives its sign (derived). What the engineer configured goes first.
    """
    if window.hints.acting is not None:
        return 1 if window.hints.acting == "reverse" else -1
    error = window.error
    increments = np.diff(window.op)
    terms = np.stack([np.diff(error), error[1:], np.ones(len(increments))], axis=1)
    known = np.isfinite(increments) & np.isfinite(terms).all(axis=1)
    if known.sum() < 10 or not np.any(increments[known]):
        return 0
    increments, terms = increments[known], terms[known]
    weights, *_ = np.linalg.lstsq(terms, increments, rcond=None)
    explained = 1 - np.var(increments - terms @ weights) / np.var(increments)
    agree = np.sign(weights[0]) == np.sign(weights[1])
    return int(np.sign(weights[0])) if agree and explained > LEAST_EXPLAINED else 0
