"""Which effects would change the predictions as one that was fitted does: its neighbours in this record.

An effect is named only where it is likelier than what could pass for it. What could is read from the record:
the change of the predictions by the fitted effect is compared with the change by each other effect at many of
its values, less what a small change of the smaller model does as well. Nothing is fitted.
"""

from __future__ import annotations

import contextlib
from typing import TYPE_CHECKING

import numpy as np

from agent.physics.foreign import EffectError
from agent.workbench.residual.movable import beyond, movable
from agent.workbench.residual.state_dependence import directions
from agent.workbench.shown.changes import changes
from agent.workbench.shown.score import NEW

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agent.analysis.record.recording import FloatArray
    from agent.physics.effect import Effect
    from agent.workbench.predictor import Predictor

SHARED = 0.5
"""Part of the squares of a change that another effect makes as well, from which on it is a neighbour."""


def neighbours(
    smaller: tuple[Predictor, FloatArray], larger: tuple[Predictor, FloatArray], effects: Sequence[Effect]
) -> list[Effect]:
    """Return the effects that could pass for the one that a larger model has, in their order.

    Args:
        smaller: A model on a linear base, and where it predicts best.
        larger: The same with one effect more.
        effects: That could be added to the smaller one.
    """
    predicts, best = smaller
    known = movable(predicts, best)
    moved = larger[0].free_run(larger[1]) - predicts.free_run(best)
    change = beyond(predicts.whitened(moved[:, np.newaxis])[:, 0], known)
    whole, found = float(change @ change), []
    for each in effects:
        with contextlib.suppress(EffectError):  # the trial itself reports it
            if _shared(predicts, best, each, known, change) >= SHARED * whole:
                found.append(each)
    return found


def _shared(
    predicts: Predictor, best: FloatArray, effect: Effect, known: FloatArray, change: FloatArray
) -> float:
    """Return the most squares of a change, (m,), that an effect makes as well, PV units squared."""
    most = 0.0
    for added in changes(predicts, best, effect):
        white = predicts.whitened(added)
        new = beyond(white, known)
        if np.isfinite(new).all() and np.sum(new**2) > NEW * np.sum(white**2):
            along = directions(new).T @ change
            most = max(most, float(along @ along))
    return most
