"""Did what happened once happen just when moves of OP arrived? Then their answer may be what changed.

A load knows nothing of what OP did before, so that moves of OP arrive at its instants no oftener than at any
others. What stands for a missing effect of valve or process is wanted where they do.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.ndimage import maximum_filter1d
from scipy.stats import combine_pvalues

from agent.workbench.instant_order import instants_of

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray
    from agent.workbench.predictor import Predictor

BEFORE = 2
"""Samples before an instant in which a move that arrives is one with it. None after it: those may be the
controller's answer."""
LEVEL = 0.01
"""Below it, instants know of OP; a load that steps by itself is doubted once in a hundred times."""


def coincidence_p(predicts: Predictor, best: FloatArray) -> float:
    """Return how likely the instants of the last effect lie as near to where moves of OP arrive, by chance.

    A move arrives where the response bends. The ranks of what it bends by at the instants are uniform where
    these know nothing of OP; they are combined by Fisher's method.

    Args:
        predicts: Of a model whose last effect happened once, on a linear base.
        best: The point of the unit cube where its predictions are best, (k,).
    """
    objective, values = predicts.objective, predicts.space.values(best)
    record, effect = objective.record, objective.model.effects[-1]
    response = objective.layout.response(objective.layout.position(record.op, values), values)
    bends = np.abs(np.diff(response, 2, prepend=response[0], append=response[-1]))
    nearby = maximum_filter1d(bends, BEFORE + 1, origin=BEFORE // 2)  # of each sample and those before it
    at = (values[instants_of(predicts, effect.name)] / record.facts.ts).astype(np.intp)
    ranks = np.mean(nearby >= nearby[at][:, np.newaxis], axis=1)
    return float(combine_pvalues(ranks).pvalue)
