"""Whether the innovations go along with an effect before it is fitted: a score test at many of its values.

What an effect would add to the predictions, less all that a small change of the model's own numbers does, is
compared with the innovations. By how much the part of them that goes along with it is larger than their
variance is by how much likelier the record is with the effect, twice a logarithm, to first order (Rao 1948).
No effect is fitted, so that a large library costs little: what is fitted shows here first.
"""

from __future__ import annotations

import contextlib
import math
from typing import TYPE_CHECKING

import numpy as np

from agent.physics.effect import SpottedEffect
from agent.physics.foreign import EffectError
from agent.workbench.checks.lacking import LARGER_DYNAMICS
from agent.workbench.inputs.measured_input import MeasuredInput
from agent.workbench.residual.movable import beyond, movable
from agent.workbench.residual.state_dependence import directions
from agent.workbench.residual.very_strong import VERY_STRONG
from agent.workbench.shown.changes import changes

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping, Sequence

    from agent.analysis.record.recording import FloatArray
    from agent.physics.effect import Effect
    from agent.workbench.hooks import Map
    from agent.workbench.predictor import Predictor

WORTH_A_FIT = 0.5 * VERY_STRONG
"""A score from which on an effect of its family is fitted: a fit gains more than the first order says. Of the
confirmed ones on the loops of docs/decisions/0072 the least has 9, the larger dynamics apart."""
MOST_GAIN = 10.0
"""What has a tenth of the best score cannot become the best: a fit gains some times more than the first order
says (8 times for a sensor's dead band, the most that was named in 150 loops, docs/decisions/0105)."""
PREDICTED = "sinusoid"
"""Always fitted: an autoregression predicts a wave, so that the innovations hardly go along with it."""
SELDOM = frozenset(
    {
        "split_range",
        "pv_gain",
        "square_law",
        "titration",
        "sensor_deadband",
        "transport_delay",
        "wave",
    }
)
"""Effects that are seldom missing: on a base without predictions, where nothing is scored, not tried."""
SHARES = 4
"""Parts in which effects are scored: each has to learn once what the model can do itself."""
NEW = 1e-6
"""Part of a change that the model cannot do itself, below which it is rounding."""


def worth_a_fit(
    effects: Sequence[Effect],
    predictions: tuple[Predictor, FloatArray] | None,
    events: Collection[str] = (),
    run: Map = map,
) -> list[Effect]:
    """Return the effects whose family the innovations hint at, in their order.

    The best family always, events, a wave, measured inputs, which somebody named, and the larger dynamics,
    which dead time and lag of a smaller model hide to first order.

    Args:
        effects: That could be added.
        predictions: Of the model without them, and where they are best; None: not known.
        events: Names of those that happened once, whose instants no slope shows.
        run: Works on several at a time.
    """
    if predictions is None:
        return [each for each in effects if each.name not in SELDOM]
    return promising(effects, scores_of(effects, *predictions, run), events)


def scores_of(
    effects: Sequence[Effect], predicts: Predictor, best: FloatArray, run: Map = map
) -> dict[str, float]:
    """Return ``Scores.of`` each effect by its name, but for those that fail: a trial reports how.

    ``run`` works on several at a time.
    """
    found = {}
    for own in run(_scores_of, [(each, predicts, best) for each in shares_of(effects)]):
        found.update(own)
    return found


def shares_of(effects: Sequence[Effect]) -> list[tuple[Effect, ...]]:
    """Return effects in ``SHARES``, for as many processes at most; none of them is empty."""
    return [tuple(effects[k::SHARES]) for k in range(min(SHARES, len(effects)))]


def _scores_of(share: tuple[tuple[Effect, ...], Predictor, FloatArray]) -> dict[str, float]:
    effects, predicts, best = share
    scores, found = Scores(predicts, best), {}
    for each in effects:
        with contextlib.suppress(EffectError):
            found[each.name] = scores.of(each)
    return found


def promising(
    effects: Sequence[Effect], scores: Mapping[str, float], events: Collection[str] = ()
) -> list[Effect]:
    """Return the effects that are worth a fit by their scores, as ``worth_a_fit`` says."""
    best: dict[str, float] = {}
    for each in effects:
        if each.name in scores:
            best[each.family] = max(best.get(each.family, 0.0), scores[each.name])
    ranked = sorted(best, key=lambda family: -best[family])
    most = best[ranked[0]] if ranked else 0.0
    least = most / MOST_GAIN
    anyway = {each.name for each in effects if each.name not in scores or isinstance(each, MeasuredInput)}
    anyway.update((PREDICTED, *LARGER_DYNAMICS, *events))
    kept = {family for family in ranked if best[family] >= min(most, max(WORTH_A_FIT, least))}
    return [each for each in effects if each.family in kept or each.name in anyway]


class Scores:
    """The innovations of one model, and what it can do by a small change of its numbers."""

    def __init__(self, predicts: Predictor, best: FloatArray) -> None:
        """``best``: the point of the unit cube where the predictions are best, (k,)."""
        self._predicts, self._best = predicts, best
        self._known = movable(predicts, best)
        left = predicts.residual(best)
        self._left = beyond(left, self._known)
        self._variance = float(left @ left) / max(len(left) - self._known.shape[1], 1)

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
