"""One effect tried on top of a model: fitted to the whole record, and to each fold."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from agent.physics.effect import SpottedEffect
from agent.physics.effects.hysteresis import HysteresisEffect
from agent.workbench.fit import Fit, nested_fit
from agent.workbench.folds import Folds, HeldOut, held_out
from agent.workbench.valve_starts import ValveStart, with_valve

if TYPE_CHECKING:
    from agent.analysis.recording import FloatArray
    from agent.physics.effect import Effect
    from agent.workbench.record import Record


@dataclass(frozen=True, slots=True)
class Trial:
    """What to try; travels to another process."""

    smaller: Fit
    effect: Effect
    record: Record
    folds: Folds
    valves: tuple[ValveStart, ...] = ()
    """That the quantifier found, to start from."""


@dataclass(frozen=True, slots=True)
class Tried:
    """A model and how it does on blocks that it did not see."""

    fit: Fit
    held_out: HeldOut


def tried(trial: Trial) -> Tried:
    """Fit the model with the effect, and predict each fold."""
    model = trial.smaller.model
    larger = replace(model, effects=(*model.effects, trial.effect))
    fitted = nested_fit(trial.smaller, larger, trial.record, _starts(trial))
    return Tried(fitted, held_out(fitted, trial.record, trial.folds))


def _starts(trial: Trial) -> FloatArray | None:
    effect = trial.effect
    if isinstance(effect, SpottedEffect):
        residual = np.where(trial.record.weight > 0, trial.record.pv - trial.smaller.pv, np.nan)
        spots = effect.spotted(residual, trial.record.facts)
        return np.hstack((np.tile(trial.smaller.values, (len(spots), 1)), spots))
    if not trial.valves or not isinstance(effect, HysteresisEffect):
        return None
    names = tuple(name for name, _ in trial.smaller.model.parameters(trial.record.facts))
    return np.array(
        [
            np.concatenate((old, effect.values_of(valve.bands, valve.start)))
            for valve in trial.valves
            for old in (with_valve(trial.smaller.values, names, valve), trial.smaller.values)
        ]
    )
