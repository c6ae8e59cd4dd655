"""Whether the innovations go along with an effect before it is fitted: a score test at many of its values.

What an effect would add to the predictions, less all that a small change of the model's own numbers does, is
compared with the innovations. By how much the part of them that goes along with it is larger than their
variance is by how much likelier the record is with the effect, twice a logarithm, to first order (Rao 1948).
No effect is fitted, so that a large library costs little: one that is seldom missing must show here first.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from agent.physics.effect import SpottedEffect
from agent.workbench.residual.state_dependence import directions, left_of_start
from agent.workbench.residual.very_strong import VERY_STRONG
from agent.workbench.search import hypercube
from agent.workbench.space import space_of

if TYPE_CHECKING:
    from collections.abc import Iterator

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
PLACES = 60
"""Values of an effect that are looked at, besides those that the residual shows."""
NEW = 1e-6
"""Part of a change that the model cannot do itself, below which it is rounding."""


class Scores:
    """The innovations of one model, and what it can do by a small change of its numbers."""

    def __init__(self, predicts: Predictor, best: FloatArray) -> None:
        """``best``: the point of the unit cube where the predictions are best, (k,)."""
        self._predicts, self._best = predicts, best
        own = np.column_stack((predicts.objective.columns(best), left_of_start(predicts.objective.record)))
        white = predicts.noise.filtered(own)[predicts.kept]
        self._known = directions(np.column_stack((predicts.derivative(best), white, predicts.basis)))
        left = predicts.residual(best)
        self._left = left - self._known @ (self._known.T @ left)
        self._variance = float(left @ left) / max(len(left) - self._known.shape[1], 1)

    def worth_a_fit(self, effect: Effect) -> bool:
        """Return whether an effect is tried: unless it is seldom missing and nothing goes along with it."""
        return effect.name not in SELDOM or self.of(effect) > VERY_STRONG

    def of(self, effect: Effect) -> float:
        """Return by how much likelier the record is with an effect, twice a logarithm, to first order.

        All that is solved for but one number is paid by Schwarz's criterion.
        """
        best = 0.0
        for change in self._changes(effect):
            white = self._predicts.whitened(change)
            new = white - self._known @ (self._known.T @ white)
            if not np.isfinite(new).all() or np.sum(new**2) <= NEW * np.sum(white**2):
                continue
            along = directions(new).T @ self._left
            price = (len(along) - 1) * math.log(len(self._left))
            best = max(best, float(along @ along) / self._variance - price)
        return best

    def _changes(self, effect: Effect) -> Iterator[FloatArray]:
        """Yield what an effect adds to PV at many of its values, but for a factor, each (n, k)."""
        objective = self._predicts.objective
        record = objective.record
        model = replace(objective.model, effects=(*objective.model.effects, effect))
        space, layout = space_of(model, record.facts), model.layout(record.facts)
        values, before = objective.space.values(self._best), objective.columns(self._best)
        points = hypercube(PLACES, len(space) - len(values))
        own = [space.values(np.concatenate((self._best, each)))[len(values) :] for each in points]
        if isinstance(effect, SpottedEffect):
            own += [*effect.spotted(self._predicts.left(self._best), record.facts)]
        for each in own:
            columns = layout.columns(record.op, np.concatenate((values, each)))
            if effect.stage == "disturbance":
                yield columns[:, before.shape[1] :]
            else:
                yield columns[:, :1] - before[:, :1]
