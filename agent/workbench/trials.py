"""Tries effects on top of the models of one recording, each model and effect once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from agent.physics.effects import EFFECTS
from agent.physics.effects.hysteresis import HysteresisEffect
from agent.physics.effects.wave import RepeatingWave
from agent.physics.foreign import EffectError
from agent.workbench.candidates import AllTried, judged
from agent.workbench.checks.doubts import Tries
from agent.workbench.checks.wave_lines import is_wave
from agent.workbench.evidence import evidence_of, far_likelier
from agent.workbench.first.begun import Begun
from agent.workbench.first.deeper import deeper
from agent.workbench.first.gaining import gaining, gains
from agent.workbench.first.valves_beside import ValvesBeside
from agent.workbench.first.valves_shared import likeliest_valve, to_seek, with_valve_of
from agent.workbench.fit import fit
from agent.workbench.library import acts_on_op, happens_once, missing
from agent.workbench.paired_blocks import lowers_error
from agent.workbench.prediction_search import with_other_values
from agent.workbench.residual.holm import LEVEL
from agent.workbench.shown.excitation import excitation_of, is_untried_rival
from agent.workbench.shown.information import Shown, shown_by
from agent.workbench.shown.score import scores_of, worth_a_fit
from agent.workbench.trial import (
    Optimum,
    Tried,
    predicted,
    tried_or_failed,
    with_all_harmonics,
    with_held_out,
)
from agent.workbench.validation import rmse_on
from agent.workbench.valve_starts import with_valves

if TYPE_CHECKING:
    from agent.analysis.record.recording import LoopWindow
    from agent.physics.effect import Effect
    from agent.workbench.fit import Fit
    from agent.workbench.folds import Folds
    from agent.workbench.hooks import Map, Progress
    from agent.workbench.record import Record
    from agent.workbench.step import Step


BESIDE = 2
"""Effects that are fitted beside one with which something remains, the best by their scores."""
GIVEN = 2
"""Valves that are given to the others at most."""


@dataclass(slots=True)
class Trials:
    """What was tried on a recording, and what was found."""

    window: LoopWindow
    record: Record
    folds: Folds
    run: Map
    """Tries effects, perhaps in parallel."""
    progress: Progress
    validation: Record | None = None
    """Another recording of the loop, to which nothing is fitted."""
    _done: dict[tuple[str, ...], AllTried] = field(default_factory=dict)
    _shown: dict[tuple[str, ...], tuple[Shown, ...]] = field(default_factory=dict)
    begun: Begun = field(init=False)
    """Trials with their first fits."""

    def __post_init__(self) -> None:
        """Prepare what is looked for once."""
        valves = ValvesBeside(self.window, self.record, self.run)
        self.begun = Begun(self.record, self.folds, self.run, self.progress, valves)

    def with_hooks(self, run: Map, progress: Progress) -> Trials:
        """Return the same with other hooks; what was tried is shared, but for searches that go on."""
        other = replace(self, run=run, progress=progress)
        other.begun = replace(
            self.begun, run=run, progress=progress, valves=self.begun.valves.with_hooks(run)
        )
        return other

    @property
    def left_out(self) -> dict[str, str]:
        """Effects that others wrote and that failed in a fit -> how, with file and contract."""
        return self.begun.left_out

    @property
    def block(self) -> int:
        """Samples of the longest held-out block."""
        return int(np.bincount(self.folds.block[self.folds.block >= 0]).max())

    def deeper(self, step: Step, found: AllTried) -> Tried | None:
        """Return a model where larger ones show a deeper valley, what was tried on it discarded; or None."""
        better = deeper(step, found.models.values(), self.record, self.folds)
        if better is not None:
            del self._done[step.effects]
            self._shown.pop(step.effects, None)
        return better

    def known(self, step: Step) -> AllTried | None:
        """Return what was tried on top of a model; None where nothing was."""
        return self._done.get(step.effects)

    def all_on(self, step: Step, library: Sequence[Effect]) -> AllTried:
        """Try each effect of a library that the record can show and the model does not have."""
        if step.effects not in self._done:
            hidden = {each.effect for each in self.shown_on(step, library) if each.why_not is not None}
            candidates = [each for each in missing(step.fit.model, library) if each.name not in hidden]
            if any(isinstance(each, HysteresisEffect) for each in candidates):
                self.begun.valves.seek_beside(step.fit)
            self._done[step.effects] = self.judged_on(step, self._worth_a_fit(step, candidates), candidates)
        return self._done[step.effects]

    def _worth_a_fit(self, step: Step, effects: Sequence[Effect]) -> list[Effect]:
        """Return the effects that the innovations hint at, by a score and by a first fit."""
        self.progress("a score of each", 0, 1)
        events = {each.name for each in effects if happens_once(each, self.record.facts)}
        hinted = worth_a_fit(effects, step.predicts, events, self.run)
        return gaining(self.begun.of(step, hinted))

    def shown_on(self, step: Step, library: Sequence[Effect]) -> tuple[Shown, ...]:
        """Return what the record can show of each effect that a model does not have; empty: not known."""
        if step.predicts is None:
            return ()
        if step.effects not in self._shown:
            self.progress("what the record can show", 0, 1)
            effects = missing(step.fit.model, library)
            self._shown[step.effects] = shown_by(*step.predicts, effects, self.run)
        return self._shown[step.effects]

    def judged_on(self, step: Step, effects: Sequence[Effect], able: Sequence[Effect] = ()) -> AllTried:
        """Try these effects on top of a model; beside one that leaves something also the ``able`` ones."""
        able = able or effects
        untried = self._untried_rivals(step, able)

        def also(found: Optimum) -> list[Effect]:
            return [*self._hinted(found, able), *missing(found.fit.model, untried)]

        def answering(found: Optimum) -> list[Effect]:
            facts = self.record.facts
            lasting = [each for each in able if acts_on_op(each, facts) and not happens_once(each, facts)]
            return self._hinted(found, lasting)

        models = self.models_on(step, effects)
        screened = max(len(able), len(models))
        found = {name: evidence_of(step, each, self.record, screened) for name, each in models.items()}
        tries = Tries(step, models, found, self.record, self.begun.together, answering, screened)
        return judged(tries, self.is_worse, also, untried)

    def _untried_rivals(self, step: Step, tried: Sequence[Effect]) -> list[Effect]:
        """Return the simplest effect of each family that may be there, but was not tried."""
        did, families = excitation_of(self.record.op), {each.family for each in tried}
        simplest: dict[str, Effect] = {}
        for each in missing(step.fit.model, EFFECTS):
            if each.family not in families and is_untried_rival(each.family, did):
                simplest.setdefault(each.family, each)
        return [*simplest.values()]

    def _hinted(self, found: Optimum, able: Sequence[Effect]) -> list[Effect]:
        """Return the effects that the innovations hint at most and that gain beside a model."""
        if found.predicts is None:
            return []
        families = {each.family for each in found.fit.model.effects}
        others = [
            each
            for each in missing(found.fit.model, able)
            if each.family not in families and each.name not in self.left_out
        ]
        scores = scores_of(others, *found.predicts, self.run)
        others = sorted((each for each in others if each.name in scores), key=lambda each: -scores[each.name])
        return [each.effect for each in self.begun.of(found, others[:BESIDE]) if gains(each)]

    def both(self, smaller: Step, found: AllTried, name: str, rival: Effect) -> Tried | None:
        """Return the model with an effect and a rival, if each is confirmed beside the other.

        Each must lower the held-out error beside the other as an effect must lower that of a model, and all
        but a wave make the record far likelier; else either explains what the other does, and None is
        returned.
        As one effect, two are not confirmed where a check lowers either, or where validation is worse with
        them.
        """
        if {name, rival.name} & found.lowered:
            return None
        alone = found.models[name], found.models[rival.name]
        larger = with_held_out(self.begun.together(alone[0], rival), self.record, self.folds)
        if any(self.is_worse(each.fit, larger.fit) for each in (smaller, *alone)):
            return None
        for one, other in (alone, alone[::-1]):
            if not lowers_error(one.held_out.losses, larger.held_out.losses, LEVEL):
                return None
            if not (is_wave(other.fit) or far_likelier(one, larger, self.record)):
                return None
        return larger

    def refined(self, found: Tried) -> Tried:
        """Return a model whose last effect was added: with the valve and the harmonics that it needs."""
        found = self.with_valve_anew(found)
        tried = isinstance(found.fit.model.effects[-1], RepeatingWave)  # whose trial ended with all of them
        return found if tried else self.with_all_harmonics(found)

    def with_valve_anew(self, found: Tried) -> Tried:
        """Return a model with its valve sought again beside what was added since, if that predicts better."""
        stems = [each for each in found.fit.model.effects[:-1] if isinstance(each, HysteresisEffect)]
        if not stems or found.predicts is None:
            return found
        self.progress("another valve", 0, 1)
        points = with_valves(found.fit, stems[0], self.begun.valves_beside(found.fit), self.record.facts)
        if not len(points):
            return found
        predicts, at = found.predicts
        other = with_other_values(predicts, at, predicts.space.at(points))
        return found if other is None else self.predicted(other[0].fit(other[1]))

    def with_all_harmonics(self, found: Tried) -> Tried:
        """Return a model with as many harmonics of its wave, if it has one, as the record needs."""
        larger = with_all_harmonics(found, self.record)
        return found if larger is found else with_held_out(larger, self.record, self.folds)

    def without(self, fitted: Fit, name: str) -> Tried:
        """Return the model without one of its effects, refitted from the values that it has."""
        kept = np.array(
            [
                full.partition(".")[0] != name or "." not in full
                for full, _ in fitted.model.parameters(self.record.facts)
            ]
        )
        effects = tuple(each for each in fitted.model.effects if each.name != name)
        starts = fitted.values[np.newaxis, kept]
        return self.predicted(
            fit(replace(fitted.model, effects=effects), self.record, self.record.weight, starts)
        )

    def predicted(self, fitted: Fit) -> Tried:
        """Return a fit with its held-out error."""
        return predicted(fitted, self.record, self.folds)

    def is_worse(self, smaller: Fit, larger: Fit) -> bool:
        """Return whether a larger model follows the other recording less well than a smaller one."""
        other = self.validation
        return other is not None and rmse_on(larger, other) > rmse_on(smaller, other)

    def models_on(self, smaller: Step, effects: Sequence[Effect]) -> dict[str, Tried]:
        """Try effects, the most promising first; one that fails is left out from then on."""
        trials = sorted(self.begun.of(smaller, effects), key=lambda each: -each.criterion)
        names = [each.effect.name for each in trials]
        models = {}
        for done, found in enumerate(self.run(tried_or_failed, trials)):
            if isinstance(found, EffectError):
                self.left_out[names[done]] = str(found)
            else:
                models[names[done]] = found
            self.progress(names[min(done + 1, len(names) - 1)], done + 1, len(names))
        self._share_valves(models)
        return {each.name: models[each.name] for each in effects if each.name in models}

    def _share_valves(self, models: dict[str, Tried]) -> None:
        """Give each effect of hysteresis the valve of the likeliest, where it predicts better with it.

        One that becomes the likeliest by it gives the others its own.
        """
        given = None
        for _ in range(GIVEN):
            likeliest = likeliest_valve(models)
            if likeliest in {None, given}:
                break
            seeking = to_seek(models, likeliest)
            tasks = [(each, self.record, self.folds) for each in seeking.values()]
            found = zip(seeking, self.run(with_valve_of, tasks), strict=True)
            models.update({name: better for name, better in found if better is not None})
            given = likeliest
