"""The base by name, or the one with which a record is likeliest.

Each base is fitted alone. The innovations decide as they do between effects: a later base must make the
record very much likelier than the best before it, on the samples that both predict, all its numbers paid by
Schwarz's criterion: those that are searched, those that are solved for, level and drift among them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from agent.identify.noise.autoregression import innovations
from agent.identify.noise.student import student_likelihood
from agent.physics.bases import BASES
from agent.workbench.library import base_named
from agent.workbench.residual.very_strong import VERY_STRONG
from agent.workbench.session.opening import opened

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray, LoopWindow
    from agent.physics.bases import Base
    from agent.workbench.evidence import ModelAtBest
    from agent.workbench.hooks import Map, Progress
    from agent.workbench.trial import Tried
    from agent.workbench.trials import Trials

AUTO = "auto"


def based(
    window: LoopWindow, name: str, run: Map, progress: Progress
) -> tuple[Base, tuple[Trials, Tried] | str]:
    """Return a base and the recording opened with it, or in words why it is not testable.

    Args:
        window: The recording.
        name: Of the base; ``auto``: the likeliest.
        run: Tries effects, perhaps in parallel.
        progress: Called with what is tried next.

    Raises:
        ValueError: There is no such base.
    """
    if name != AUTO:
        base = base_named(name)
        return base, opened(window, base, run, progress)
    chosen: tuple[Base, tuple[Trials, Tried] | str] | None = None
    best = None
    for base in BASES:
        found = opened(window, base, run, progress)
        predicted = None if isinstance(found, str) else predicted_by(found[1])
        if chosen is None or (predicted is not None and (best is None or far_likelier(predicted, best))):
            chosen, best = (base, found), predicted
    if chosen is None:
        raise ValueError("there is no base")
    return chosen


@dataclass(frozen=True, slots=True)
class Predicted:
    """How a base alone predicts a record."""

    innovations: FloatArray
    """PV units, (n,), NaN where there is no prediction."""
    numbers: int
    """That it has, searched and solved for."""
    least: float
    """Variance of the innovations below which it is rounding, PV units squared."""


def predicted_by(alone: ModelAtBest) -> Predicted | None:
    """Return how a model predicts its record, where it does so best; None where that is not known."""
    if alone.predicts is None:
        return None
    predicts, best = alone.predicts
    new = innovations(predicts.left(best), longest=True)
    if new is None:
        return None
    solved = predicts.solved_for(predicts.objective.columns(best)).shape[1]
    return Predicted(new.values, len(best) + solved + predicts.basis.shape[1], predicts.rounding)


def far_likelier(one: Predicted, other: Predicted) -> bool:
    """Return whether a record is very much likelier with one base than with another."""
    both = np.isfinite(one.innovations) & np.isfinite(other.innovations)
    count = int(np.count_nonzero(both))
    if not count:
        return False
    before, after = (student_likelihood(each.innovations[both], each.least) for each in (other, one))
    gained = 2.0 * (after - before)
    return gained - (one.numbers - other.numbers) * math.log(count) > VERY_STRONG
