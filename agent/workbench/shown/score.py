"""Whether the innovations go along with an effect before it is fitted: a score test at many of its values.

What an effect would add to the predictions, less all that a small change of the model's own numbers does, is
compared with the innovations. By how much the part of them that goes along with it is larger than their
variance is by how much likelier the record is with the effect, twice a logarithm, to first order (Rao 1948).
No effect is fitted, so that a large library costs little: one that is seldom missing must show here first.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from agent.physics.effect import SpottedEffect
from agent.workbench.residual.movable import beyond, movable
from agent.workbench.residual.state_dependence import directions
from agent.workbench.residual.very_strong import VERY_STRONG
from agent.workbench.shown.changes import changes

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray
    from agent.physics.effect import Effect
    from agent.workbench.predictor import Predictor

SELDOM = frozenset(
    {
        "split_range",
        "pv_gain",
        "titration",
        "sensor_deadband",
        "transport_delay",
        "wave",
    }
)
"""Effects that are seldom missing, tried only where the innovations go along with them."""
NEW = 1e-6
"""Part of a change that the model cannot do itself, below which it is rounding."""


class Scores:
    """The innovations of one model, and what it can do by a small change of its numbers."""

    def __init__(self, predicts: Predictor, best: FloatArray) -> None:
        """``best``: the point of the unit cube where the predictions are best, (k,)."""
        self._predicts, self._best = predicts, best
        self._known = movable(predicts, best)
        left = predicts.residual(best)
        self._left = beyond(left, self._known)
        self._variance = float(left @ left) / max(len(left) - self._known.shape[1], 1)

    def worth_a_fit(self, effect: Effect) -> bool:
        """Return whether an effect is tried: unless it is seldom missing and nothing goes along with it."""
        return effect.name not in SELDOM or self.of(effect) > VERY_STRONG

    def of(self, effect: Effect) -> float:
        """Return by how much likelier the record is with an effect, twice a logarithm, to first order.

        All that is solved for but one number is paid by Schwarz's criterion.
        """
        seen: tuple[FloatArray, ...] = ()
        if isinstance(effect, SpottedEffect):
            seen = (*effect.spotted(self._predicts.left(self._best), self._predicts.objective.record.facts),)
        best = 0.0
        for change in changes(self._predicts, self._best, effect, seen):
            white = self._predicts.whitened(change)
            new = beyond(white, self._known)
            if not np.isfinite(new).all() or np.sum(new**2) <= NEW * np.sum(white**2):
                continue
            along = directions(new).T @ self._left
            price = (len(along) - 1) * math.log(len(self._left))
            best = max(best, float(along @ along) / self._variance - price)
        return best
