"""How much of PV the response to OP explains at all: a record where it explains nothing shows no effect.

The response of the base is judged as an effect is: on stretches that no fit saw, against a model that has
level and slow drift only.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from agent.workbench.folds import block_losses
from agent.workbench.paired_blocks import LEAST_PERCENT, Reduction, reduction
from agent.workbench.projection import nuisance_part
from agent.workbench.residual.axes import OF_TIME
from agent.workbench.residual.state_dependence import LEVEL

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agent.workbench.residual.where import Failure
    from agent.workbench.step import Step
    from agent.workbench.trials import Trials


def explained_by_op(step: Step, trials: Trials) -> Reduction:
    """Return by how much the model reduces the held-out squared error of level and drift, %."""
    record, folds = trials.record, trials.folds
    alone = nuisance_part(record, np.zeros(len(record)), record.weight)
    return reduction(block_losses(record, folds, alone), step.held_out.losses, np.random.default_rng(0))


def is_informative(explained: Reduction, failures: Sequence[Failure]) -> bool:
    """Return whether a record can show a missing effect.

    It cannot where OP explains less than the smallest effect that counts and the residual follows no axis of
    OP either: then nothing in PV is known to come from the valve.
    """
    follows_op = any(each.p < LEVEL and each.axis not in OF_TIME for each in failures)
    return explained.percent >= LEAST_PERCENT or follows_op


def not_informative_words(explained: Reduction) -> str:
    """Return why nothing can be said, and what to record instead."""
    share = max(explained.percent, 0.0)
    return (
        f"this record is not informative: OP explains {share:.1f} % of what PV does on stretches that no fit "
        f"saw, and an effect counts from {LEAST_PERCENT:.0f} %; record a stretch where the set point moves "
        "several times, or where OP is stepped in manual"
    )
