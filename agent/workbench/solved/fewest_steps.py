"""A load that steps once is one step: the model with some of its steps alone."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

from agent.physics.effects.load_step import LoadStepEffect
from agent.workbench.fit import fit_at, refit_from
from agent.workbench.projection import target_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agent.analysis.record.recording import FloatArray
    from agent.workbench.fit import Fit
    from agent.workbench.predictor import Predictor
    from agent.workbench.record import Record

NUMBERS_OF_A_STEP = 3
"""By how many logarithms of the samples a step costs more: its height, and its instant twice."""


def variances_with_fewer(predicts: Predictor, at: FloatArray) -> list[float]:
    """Return the least mean square of the innovations with all columns of the last effect, and with fewer.

    PV units squared; one by one fewer down to one step of a load; of every other effect with all alone.
    Nothing but heights is solved for anew.
    """
    effect = predicts.objective.model.effects[-1]
    found = [predicts.variance(at)]
    if isinstance(effect, LoadStepEffect) and np.isfinite(found[0]):
        columns = predicts.objective.columns(at)
        white = predicts.whitened(columns)
        rest = columns.shape[1] - effect.steps
        for steps in range(effect.steps - 1, 0, -1):
            tried = []
            for kept in combinations(range(effect.steps), steps):
                left = predicts.left_by(white[:, [*range(rest), *(rest + each for each in kept)]])
                tried.append(float(left @ left) / len(left))
            found.append(min(tried))
    return found


def with_steps(fitted: Fit, record: Record, steps: int) -> Fit:
    """Return a model whose last effect is steps of a load with so many of them, fitted again.

    It begins with those that leave least: of two that nearly cancel each other both are high.
    """
    effect = fitted.model.effects[-1]
    if not isinstance(effect, LoadStepEffect):
        raise TypeError(f"{effect.name} has no steps")
    target = target_of(record, record.weight, linear=fitted.model.base.linear)
    model = replace(fitted.model, effects=(*fitted.model.effects[:-1], replace(effect, steps=steps)))
    tried = [
        fit_at(model, record, target, _values_of(fitted, effect.steps, kept))
        for kept in combinations(range(effect.steps), steps)
    ]
    return refit_from(model, record, min(tried, key=lambda each: each.error).values)


def _values_of(fitted: Fit, steps: int, kept: Sequence[int]) -> FloatArray:
    """Return the values of a model with some of the steps of its last effect, own units."""
    own = steps + 1  # instants and lag
    instants = fitted.values[-own:-1][list(kept)]
    return np.concatenate((fitted.values[:-own], instants, fitted.values[-1:]))
