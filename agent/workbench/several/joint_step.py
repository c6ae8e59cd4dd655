"""A model on all recordings of one loop, and its error in each with what the others say of the loop."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from agent.workbench.inputs.measured_input import at_home
from agent.workbench.several.joint import JointFit, fitted_together
from agent.workbench.validation import of_loop, rmse_on

if TYPE_CHECKING:
    from collections.abc import Collection

    from agent.analysis.record.recording import FloatArray
    from agent.workbench.fit import Fit
    from agent.workbench.predictor import Predictor
    from agent.workbench.record import Record


@dataclass(frozen=True, slots=True)
class JointStep:
    """A model on all recordings."""

    added: str | None
    """None for the base."""
    effects: tuple[str, ...]
    fitted: JointFit
    rmse: tuple[float, ...]
    """Of the free run in each recording, PV units."""
    rmse_held_out: tuple[float, ...]
    """The same with what belongs to the loop fitted to the other recordings only."""
    rmse_validation: float | None
    """The same on another recording that no fit used; None without one."""


@dataclass(frozen=True, slots=True)
class JointJob:
    """What to fit to all recordings; travels to another process."""

    models: tuple[tuple[Predictor, FloatArray], ...]
    """The same model on each recording, and the point of the unit cube where it predicts best there alone."""
    own: Collection[str]
    """Parameters that each recording has for itself."""
    other: Record | None
    """Another recording, for validation."""
    added: str | None
    """Of the step."""


def joint_step(job: JointJob) -> JointStep | None:
    """Return a model fitted to all recordings, each also predicted by the rest; None where one is short."""
    models = job.models
    whole = fitted_together(models, job.own)
    if whole is None:
        return None
    shared = whole.joint.values(whole.at)
    rmse, held_out = [], []
    for i, (predicts, _) in enumerate(models):
        record = predicts.objective.record
        rest = fitted_together([each for k, each in enumerate(models) if k != i], job.own, shared[i])
        if rest is None:
            return None
        there = _with_mean(whole.fits[i], record, rest)
        held_out.append(rmse_on(replace(there, model=at_home(there.model)), record))
        rmse.append(math.sqrt(whole.fits[i].error / max(float(record.weight.sum()), 1.0)))
    effects = tuple(each.name for each in whole.fits[0].model.effects)
    own = _with_mean(whole.fits[0], models[0][0].objective.record, whole)
    validated = None if job.other is None else rmse_on(own, job.other)
    return JointStep(job.added, effects, whole, tuple(rmse), tuple(held_out), validated)


def _with_mean(own: Fit, record: Record, others: JointFit) -> Fit:
    """Return the model of a recording with the mean of what belongs to the loop in others.

    A wave may have more harmonics in one recording than in another: amounts of loads stay a recording's own.
    """
    coefficients = own.coefficients.copy()
    coefficients[of_loop(own, record)] = np.mean(
        [
            each.coefficients[of_loop(each, predicts.objective.record)]
            for predicts, each in zip(others.joint.predictors, others.fits, strict=True)
        ],
        axis=0,
    )
    values = np.mean([each.values for each in others.fits], axis=0)
    return replace(own, values=values, coefficients=coefficients)
