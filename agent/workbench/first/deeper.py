"""A model at the values that a larger one found: an effect has no credit for a valley that is not its own.

The error over a dead time has a valley within each sample, and the search of a model may miss the deepest. A
larger model that falls into it seems to explain what the smaller one does with other numbers.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from agent.workbench.fit import refit
from agent.workbench.prediction_search import with_other_values
from agent.workbench.residual.very_strong import VERY_STRONG
from agent.workbench.trial import Optimum, with_held_out

if TYPE_CHECKING:
    from collections.abc import Iterable

    from agent.workbench.evidence import ModelAtBest
    from agent.workbench.folds import Folds
    from agent.workbench.record import Record
    from agent.workbench.trial import Tried


def deeper(smaller: ModelAtBest, larger: Iterable[ModelAtBest], record: Record, folds: Folds) -> Tried | None:
    """Return a model where it makes the record far likelier than where it was fitted; None where it does not.

    Args:
        smaller: The model.
        larger: Models with one effect more each.
        record: What all are fitted to.
        folds: Of its samples.
    """
    if smaller.predicts is None:
        return None
    predicts, best = smaller.predicts
    far = predicts.error(best) * math.exp(-VERY_STRONG / len(predicts.pv))
    points = [
        predicts.space.at(own.space.values(at)[: len(best)])
        for own, at in (each.predicts for each in larger if each.predicts is not None)
    ]
    points = [each for each in points if predicts.error(each) < far]
    found = with_other_values(predicts, best, np.array(points)) if points else None
    if found is None:
        return None
    fitted = refit(found[0].fit(found[1]), record, record.weight)
    return with_held_out(Optimum(fitted, found), record, folds)
