"""Was what happened once an event of another kind?

A gain that changes moves the level as well, unless it does so at its pivot: it does what a load does that
steps, and may be taken for it; so may a load for it, where few moves of OP show it. And where OP comes to
another level and stays, as behind a stop, another answer there is one from then on.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy import stats

from agent.identify.noise.student import student_likelihood
from agent.physics.bases.linear_process import LinearProcess
from agent.physics.signals.steps import lagged_steps
from agent.workbench.fit_order import instants_of
from agent.workbench.residual.very_strong import VERY_STRONG

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from agent.analysis.record.recording import FloatArray
    from agent.workbench.predictor import Predictor

LAGS = (0.0, 0.03, 0.06, 0.12, 0.25, 0.5, 1.0)
"""Of the steps, dominant periods."""
MOVE = 0.01
"""Of the valve in a sample, part of its span, from which on it moves."""
LEVELS = np.linspace(0.05, 0.95, 19)
"""Of OP, parts of the record below them."""


def is_only_another_level(predicts: Predictor, best: FloatArray) -> bool:
    """Return whether another gain is no more than another level, of the load or of OP.

    It is more where the record is very much likelier with it: beside steps of the level at its instants, of
    all lags, and beside another answer from that level of OP on with which the record is likeliest.

    Args:
        predicts: Of a model whose last effect is another gain from an instant on.
        best: The point of the unit cube where its predictions are best, (k,).
    """
    event = _event(predicts, best)
    steps = np.hstack([event.steps(each) for each in event.instants])
    op = predicts.objective.record.op
    above = [event.answer(op > level) for level in np.nanquantile(op, LEVELS)]
    return not all(event.gains(each, event.own) for each in (steps, min(above, key=event.unlikely)))


def begins_with_op(predicts: Predictor, best: FloatArray) -> float:
    """Return how likely steps of a load begin by chance as near to where PV begins to answer moves of OP.

    A load from outside knows nothing of OP: its instants have any distance to the moves before them. What a
    model lacks of PV's answer shows where PV answers: steps after both moves of a bump test stand for a dead
    time that depends on flow (``transport_delay`` 91467). A move after a step may be OP's answer to it, and
    does not count. The chances of all steps together: R. A. Fisher, Statistical Methods for Research Workers
    (1932), 21.1.

    Args:
        predicts: Of a model whose last effect is steps.
        best: The point of the unit cube where its predictions are best, (k,).
    """
    event = _event(predicts, best)
    process = predicts.objective.layout.process_of(event.values)
    if not isinstance(process, LinearProcess):
        return 1.0  # the response of a balance is PV itself
    ts, position = predicts.objective.record.facts.ts, event.position
    moves = ts * (1 + np.flatnonzero(np.abs(np.diff(position)) > MOVE * np.ptp(position)))
    if not len(moves):
        return 1.0  # OP goes slowly all the time
    by_chance = 0.0
    for instant in event.instants:
        answers = moves[moves <= instant] + process.delay
        distance = float(np.abs(answers - instant).min(initial=ts * len(position)))
        by_chance += math.log(min(1.0, len(moves) * (2 * distance + ts) / (ts * len(position))))
    return float(stats.chi2.sf(-2 * by_chance, 2 * len(event.instants)))


@dataclass(frozen=True, slots=True)
class _Event:
    """What the last effect of a model does, and what others may do in its place."""

    predicts: Predictor
    values: FloatArray
    """Of the model, own units, (k,)."""
    instants: list[float]
    """Of the effect, s."""
    time: FloatArray
    """(n,), s."""
    rest: FloatArray
    """Columns of all else, (n, k), PV units but for a factor."""
    own: FloatArray
    """Columns of the effect, (n, k)."""
    position: FloatArray
    """Of the valve, OP units, (n,)."""

    def steps(self, instant: float) -> FloatArray:
        """Return steps of the level of all lags, and what a step of the inflow does, (n, k)."""
        objective = self.predicts.objective
        period = objective.record.facts.period
        inflow = np.asarray(self.time > instant, dtype=np.float64)[:, np.newaxis]
        behind = objective.layout.answers(self.position, inflow, self.values)
        own = [lagged_steps(self.time, np.array([instant]), lag * period)[0] for lag in LAGS]
        return np.column_stack([*own, behind])

    def answer(self, there: NDArray[np.bool_]) -> FloatArray:
        """Return what PV answers more to OP in part of the samples, gain and level, (n, 2)."""
        layout = self.predicts.objective.layout
        moves = np.where(there, self.position - self.position.mean(), 0.0)
        inputs = np.column_stack((there.astype(np.float64), moves))
        return layout.answers(self.position, inputs, self.values)

    def unlikely(self, columns: FloatArray) -> float:
        """Return minus twice the logarithm of the likelihood with columns at their best beside the rest.

        Less a constant.
        """
        left = self.predicts.left_by(self.predicts.whitened(np.hstack((self.rest, columns))))
        return -2.0 * student_likelihood(left, self.predicts.rounding)

    def gains(self, beside: FloatArray, columns: FloatArray) -> bool:
        """Return whether the record is very much likelier with columns beside others (Schwarz)."""
        price = columns.shape[1] * math.log(len(self.predicts.pv))
        gained = self.unlikely(beside) - self.unlikely(np.hstack((beside, columns)))
        return bool(gained - price > VERY_STRONG)


def _event(predicts: Predictor, best: FloatArray) -> _Event:
    objective, values = predicts.objective, predicts.space.values(best)
    record, effect = objective.record, objective.model.effects[-1]
    last = np.array([owner == effect.name for owner in objective.layout.owners(record.op, values)])
    columns, position = objective.columns(best), objective.layout.position(record.op, values)
    return _Event(
        predicts,
        values,
        values[instants_of(predicts, effect.name)].tolist(),
        np.asarray(record.facts.ts * np.arange(len(record)), dtype=np.float64),
        columns[:, ~last],
        columns[:, last],
        position,
    )
