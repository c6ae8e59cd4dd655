"""A load that steps once is one step: the model with the largest of its steps alone."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from agent.physics.effects.load_step import LoadStepEffect
from agent.workbench.fit import refit_from

if TYPE_CHECKING:
    from agent.workbench.fit import Fit
    from agent.workbench.record import Record


def with_steps(fitted: Fit, record: Record, steps: int) -> Fit:
    """Return a model whose last effect is steps of a load with so many of them, the highest, fitted again."""
    effect = fitted.model.effects[-1]
    if not isinstance(effect, LoadStepEffect):
        raise TypeError(f"{effect.name} has no steps")
    own = effect.steps + 1  # instants and lag
    heights = np.abs(fitted.coefficients[-effect.steps :])
    kept = np.sort(np.argsort(-heights)[:steps])
    instants = fitted.values[-own:-1][kept]
    values = np.concatenate((fitted.values[:-own], instants, fitted.values[-1:]))
    model = replace(fitted.model, effects=(*fitted.model.effects[:-1], replace(effect, steps=steps)))
    return refit_from(model, record, values)
