"""The trials of effects on top of models of one recording, each with its first fit, and each made once."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from agent.physics.effects.hysteresis import HysteresisEffect
from agent.physics.foreign import EffectError
from agent.workbench.trial import Trial, begins_or_failed, optimum

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agent.physics.effect import Effect
    from agent.workbench.first.valves_beside import ValvesBeside
    from agent.workbench.fit import Fit
    from agent.workbench.folds import Folds
    from agent.workbench.hooks import Map, Progress
    from agent.workbench.record import Record
    from agent.workbench.step import Step
    from agent.workbench.trial import Optimum
    from agent.workbench.valve_starts import ValveStart

    Key = tuple[tuple[str, ...], bytes, str]


@dataclass(slots=True)
class Begun:
    """Of one recording; a model is known by its effects and its values, for it may be fitted anew."""

    record: Record
    folds: Folds
    run: Map
    """Works on several at a time."""
    progress: Progress
    valves: ValvesBeside
    left_out: dict[str, str] = field(default_factory=dict)
    """Effects that others wrote and that failed in a fit -> how, with file and contract."""
    _trials: dict[Key, Trial] = field(default_factory=dict)
    _together: dict[Key, Optimum] = field(default_factory=dict)

    def of(self, smaller: Step | Optimum, effects: Sequence[Effect]) -> list[Trial]:
        """Return the trial of each effect on a model, with its first fit; one that fails is left out."""
        new = [
            self._trial(smaller, each)
            for each in effects
            if _key(smaller, each) not in self._trials and each.name not in self.left_out
        ]
        for trial, begins in zip(new, self.run(begins_or_failed, new), strict=True):
            if isinstance(begins, EffectError):
                self.left_out[trial.effect.name] = str(begins)
            else:
                instants, first = begins
                self._trials[_key(smaller, trial.effect)] = replace(trial, instants=instants, first=first)
        return [self._trials[_key(smaller, each)] for each in effects if each.name not in self.left_out]

    def together(self, one: Step | Optimum, other: Effect) -> Optimum:
        """Return a model with an effect more where it is best; no fold of it is predicted."""
        key = _key(one, other)
        if key not in self._together:
            self.progress(" and ".join(each.name for each in (*one.fit.model.effects[-1:], other)), 0, 1)
            begun = self.of(one, [other])
            self._together[key] = optimum(begun[0] if begun else self._trial(one, other))
        return self._together[key]

    def valves_beside(self, fitted: Fit) -> tuple[ValveStart, ...]:
        """Return the valves that the quantifier finds in a record less the disturbances of a model."""
        self.progress("sticking valves", 0, 1)
        return self.valves.beside(fitted)

    def _trial(self, smaller: Step | Optimum, effect: Effect) -> Trial:
        valves = self.valves_beside(smaller.fit) if isinstance(effect, HysteresisEffect) else ()
        return Trial(smaller.fit, effect, self.record, self.folds, smaller.predicts, valves)


def _key(model: Step | Optimum, effect: Effect) -> Key:
    return tuple(each.name for each in model.fit.model.effects), model.fit.values.tobytes(), effect.name
