"""The workbench: compare, see where it fails, learn what is missing, add it, watch the error fall."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from agent.physics.effects import effects as known_effects
from agent.physics.effects.hysteresis import HysteresisEffect
from agent.physics.loop_model import LoopModel
from agent.workbench.axes import physical_axes
from agent.workbench.candidates import AllTried, judged, naming, verdict_of
from agent.workbench.comparison import Comparison
from agent.workbench.comparison_json import comparison_json
from agent.workbench.decision import Decision, judge
from agent.workbench.fit import Fit, contributions, fit
from agent.workbench.folds import Folds, folds_of, held_out
from agent.workbench.hooks import Map, Progress, silent
from agent.workbench.intervals import fitted_parameters
from agent.workbench.library import applies, base_named, effect_named, library, missing
from agent.workbench.noise_floor import noise_floor
from agent.workbench.null_trial import DRAWS, NullTrial
from agent.workbench.power import smallest_reduction
from agent.workbench.record import Record, bare_record, record_of
from agent.workbench.saved_model import read_saved, saved
from agent.workbench.simulated_null import simulated_null_p
from agent.workbench.step import Step, Verdict
from agent.workbench.trial import Trial, Tried, tried
from agent.workbench.validation import rmse_on
from agent.workbench.valve_starts import ValveStart, valve_starts
from agent.workbench.where import Failure, where_it_fails

if TYPE_CHECKING:
    from agent.analysis.recording import FloatArray, LoopWindow
    from agent.physics.effect import Effect

MOST_EFFECTS = 4


class Workbench:
    """A recording, the models that were tried on it, and the way back."""

    def __init__(
        self,
        window: LoopWindow,
        base: str = "fopdt",
        validate: LoopWindow | None = None,
        without: Iterable[str] = (),
        *,
        extra: Sequence[Effect] = (),
        run: Map = map,
        tell: Progress = silent,
    ) -> None:
        """Fit the base.

        Args:
            window: The recording.
            base: Name of the process that the model begins with.
            validate: Another recording of the same loop; every step is scored on it, nothing fitted.
            without: Effects or families that are not to be tried.
            extra: Effects beside those that are installed.
            run: Tries effects, perhaps in parallel.
            tell: Is told what is tried.

        Raises:
            ValueError: No such base, effect or family.
        """
        self.window = window
        self.base = base_named(base)
        self.installed = (*known_effects(), *extra)
        self.library = library(self.installed, self.base, without)
        self.reason: str | None = None
        """In plain words why nothing can be said about the recording; None where something can."""
        self._run, self._tell = run, tell
        self._steps: list[Step] = []
        self._tried_on: dict[tuple[str, ...], AllTried] = {}
        self._valves: tuple[ValveStart, ...] | None = None
        self._validation = (
            None if validate is None else bare_record(validate, from_start=not self.base.linear)
        )
        record = record_of(window, from_start=not self.base.linear)
        if isinstance(record, str):
            self.reason = record
            return
        tell(self.base.name, 0, 1)
        fitted = fit(LoopModel(self.base), record, record.weight)
        folds = folds_of(record, fitted)
        if isinstance(folds, str):
            self.reason = folds
            return
        self._record, self._folds = record, folds
        self._push(self._predicted(fitted), None)

    @property
    def step(self) -> Step:
        """The newest step.

        Raises:
            ValueError: The recording is not testable; the text says why.
        """
        if not self._steps:
            raise ValueError(f"{self.window.loop} cannot be tested: {self.reason}")
        return self._steps[-1]

    @property
    def record(self) -> Record:
        """What the fits see."""
        return self._record

    @property
    def folds(self) -> Folds:
        """Which samples were held out together."""
        return self._folds

    def staircase(self) -> tuple[Step, ...]:
        """Return all steps, the base first; empty where the recording is not testable."""
        return tuple(self._steps)

    def compare(self) -> dict[str, FloatArray]:
        """Return PV of the newest model, of the base, and what each effect adds, PV units, each (n,)."""
        added = contributions(self.step.fit, self._record)
        return {"model": self.step.fit.pv, "base": self._steps[0].fit.pv, **added}

    def residual(self) -> FloatArray:
        """Return PV less the newest model, PV units, (n,), NaN where PV counts for nothing."""
        return np.where(self._record.weight > 0, self._record.pv - self.step.fit.pv, np.nan)

    def where_it_fails(self) -> tuple[Failure, ...]:
        """Return the residual of the newest model against each physical axis, the largest share first."""
        fitted, record = self.step.fit, self._record
        moved = any(each.stage == "valve" for each in fitted.model.effects)
        axes = physical_axes(
            record.op,
            record.facts.ts,
            record.period,
            position=fitted.model.position(record.op, fitted.values, record.facts) if moved else None,
            set_point=self.window.sp,
            start=self.window.start,
        )
        return where_it_fails(self.residual(), axes, self._block, np.random.default_rng(0))

    def candidates(self) -> Decision:
        """Try each effect that the newest model does not have, refitted with all else, and judge them."""
        return self._all_tried().decision

    def add(self, name: str) -> Step:
        """Add an effect, refit everything, and return the new step.

        Its verdict is that on the effect and its family, or on all candidates where they were tried.

        Raises:
            ValueError: No such effect; it is in the model, or does not apply to the base.
        """
        effect = effect_named(name, self.installed)
        model = self.step.fit.model
        if not applies(effect, self.base):
            raise ValueError(f"{name} does not apply to the base {self.base.name}")
        if effect not in missing(model, [effect]):
            raise ValueError(f"{name} cannot be added to a model with {', '.join(self.step.effects)}")
        found = self._tried_on.get(self.step.effects)
        if found is None or name not in found.models:
            family = [each for each in missing(model, self.library) if each.family == effect.family]
            models = self._tried(family if effect in family else [*family, effect])
            found = judged(self.step, models, self._null_p)
        verdict = naming(verdict_of(found.decision, self.where_it_fails()), name)
        self._push(found.models[name], verdict, added=name)
        return self.step

    def drop(self, name: str) -> Step:
        """Take an effect out, refit everything, and return the new step.

        Raises:
            ValueError: The model does not have it.
        """
        if name not in self.step.effects:
            raise ValueError(
                f"the model has no {name}; it has {', '.join(self.step.effects) or 'no effects'}"
            )
        self._push(self._without(name), None, dropped=name)
        return self.step

    def undo(self) -> Step:
        """Take back the last step, and return the one before.

        Raises:
            ValueError: There is only the base.
        """
        if len(self.staircase()) < 2:
            raise ValueError("there is nothing to take back")
        self._steps.pop()
        return self.step

    def auto(self) -> tuple[Step, ...]:
        """Add what is confirmed until nothing more is; after each, test the earlier effects again."""
        while self._steps and len(self.step.effects) < MOST_EFFECTS:
            decision = self.candidates()
            if decision.effect is None or decision.effect in {each.dropped for each in self._steps}:
                break
            if decision.kind in {"confirmed", "family"}:
                self.add(decision.effect)
            elif not self._add_both(decision):
                break
            self._drop_idle()
        return self.staircase()

    def save(self) -> dict[str, object]:
        """Return the newest model as a mapping of plain values, for YAML or JSON."""
        return saved(self.window.loop, self.step.fit, self._record.facts)

    def load(self, mapping: object) -> tuple[Step, ...]:
        """Add the effects of a saved model one after the other, fitted from its values; return all steps.

        Raises:
            ValueError: It is no saved model, of another loop or on another base, or has unknown effects.
        """
        model = read_saved(mapping)
        if model.loop != self.window.loop:
            raise ValueError(f"the saved model is of the loop {model.loop}, not of {self.window.loop}")
        if model.base != self.base.name:
            raise ValueError(f"the saved model has the base {model.base}, not {self.base.name}")
        effects = [effect_named(name, self.installed) for name in model.effects]
        for effect in effects:
            larger = replace(self.step.fit.model, effects=(*self.step.fit.model.effects, effect))
            starts = model.values_of(larger, self._record.facts)[np.newaxis]
            self._tell(effect.name, len(self.step.effects), len(effects))
            fitted = fit(larger, self._record, self._record.weight, starts)
            self._push(self._predicted(fitted), None, added=effect.name)
        return self.staircase()

    def comparison(self) -> Comparison:
        """Return all that is known: the staircase, and what is said of the newest model."""
        if not self._steps:
            return Comparison(self.window.loop, (), (), (), Verdict("not_testable"), None, None, self.reason)
        all_tried, failures = self._all_tried(), self.where_it_fails()
        decision, losses = all_tried.decision, self.step.held_out.losses
        rng = np.random.default_rng(0)
        best = decision.candidates[0].effect if decision.candidates else None
        count = len(decision.candidates)
        return Comparison(
            loop=self.window.loop,
            steps=self.staircase(),
            where_it_fails=failures,
            candidates=decision.candidates,
            verdict=verdict_of(decision, failures),
            noise_floor=noise_floor(self.residual(), losses, rng),
            smallest_percent=None
            if best is None
            else smallest_reduction(losses, all_tried.models[best].held_out.losses, count, rng),
            reason=None,
        )

    def result(self, recording: str | None = None) -> dict[str, object]:
        """Return the comparison as plain values: what ``slipjump compare --json`` prints."""
        return comparison_json(self.comparison(), recording or self.window.loop)

    def _all_tried(self) -> AllTried:
        key = self.step.effects
        if key not in self._tried_on:
            candidates = missing(self.step.fit.model, self.library)
            self._tried_on[key] = judged(self.step, self._tried(candidates), self._null_p)
        return self._tried_on[key]

    def _null_p(self, larger: Fit) -> float:
        """Return how likely an effect seems to explain as much where it is not there."""
        effect = larger.model.effects[-1]
        self._tell(f"{effect.name} by chance", 0, 1)
        trial = NullTrial(self.step.fit, larger, self._record, self._block)
        return simulated_null_p(trial.seen, trial, DRAWS, self._run)

    @property
    def _block(self) -> int:
        return int(np.bincount(self._folds.block[self._folds.block >= 0]).max())

    def _tried(self, candidates: Sequence[Effect]) -> dict[str, Tried]:
        if self._valves is None and any(isinstance(each, HysteresisEffect) for each in candidates):
            self._tell("sticking valves", 0, len(candidates))
            self._valves = valve_starts(self.window)
        valves = self._valves or ()
        trials = [Trial(self.step.fit, each, self._record, self._folds, valves) for each in candidates]
        names = [each.name for each in candidates]
        models = {}
        if names:
            self._tell(names[0], 0, len(names))
        for done, found in enumerate(self._run(tried, trials)):
            models[names[done]] = found
            self._tell(names[min(done + 1, len(names) - 1)], done + 1, len(names))
        return models

    def _add_both(self, decision: Decision) -> bool:
        """Add the best effect and a rival that it cannot be told from, if each is confirmed above the other.

        Both are there then; else either explains what the other does. Returns whether there is such a rival.
        """
        models = self._all_tried().models
        for name in decision.rivals:
            best = models[str(decision.effect)]
            rival = effect_named(name, self.installed)
            self._tell(f"{decision.effect} and {name}", 0, 1)
            both = tried(Trial(best.fit, rival, self._record, self._folds, self._valves or ()))
            alone = (best, models[name])
            if all(self._confirmed(each, both) for each in alone):
                effect = effect_named(str(decision.effect), self.installed)
                self._push(best, Verdict("confirmed", effect.name, effect.family), added=effect.name)
                self._push(both, Verdict("confirmed", rival.name, rival.family), added=rival.name)
                return True
        return False

    def _confirmed(self, smaller: Tried, larger: Tried) -> bool:
        name = larger.fit.model.effects[-1].name
        found = judge(smaller.held_out.losses, {name: larger.held_out.losses}, {name: name})
        return found.kind == "confirmed"

    def _drop_idle(self) -> None:
        """Take out earlier effects that reduce the held-out error no more."""
        for name in self.step.effects[:-1]:
            self._tell(f"without {name}", 0, 1)
            rest = self._without(name)
            family = effect_named(name, self.installed).family
            again = judge(rest.held_out.losses, {name: self.step.held_out.losses}, {name: family})
            if again.kind == "none":
                self._push(rest, None, dropped=name)

    def _without(self, name: str) -> Tried:
        fitted = self.step.fit
        pairs = fitted.model.parameters(self._record.facts)
        kept = np.array([full.partition(".")[0] != name or "." not in full for full, _ in pairs])
        effects = tuple(each for each in fitted.model.effects if each.name != name)
        starts = fitted.values[np.newaxis, kept]
        model = replace(fitted.model, effects=effects)
        return self._predicted(fit(model, self._record, self._record.weight, starts))

    def _predicted(self, fitted: Fit) -> Tried:
        return Tried(fitted, held_out(fitted, self._record, self._folds))

    def _push(
        self, found: Tried, verdict: Verdict | None, *, added: str | None = None, dropped: str | None = None
    ) -> None:
        record, fitted = self._record, found.fit
        counts = record.weight > 0
        missed = (record.pv - fitted.pv)[counts]
        spread = float(np.linalg.norm(record.pv[counts] - record.pv[counts].mean()))
        self._steps.append(
            Step(
                added=added,
                dropped=dropped,
                fit=fitted,
                held_out=found.held_out,
                rmse_fit=float(np.sqrt(np.mean(missed**2))),
                fit_percent=100 * (1 - float(np.linalg.norm(missed)) / spread),
                parameters=fitted_parameters(fitted, found.held_out, record),
                verdict=verdict,
                rmse_validation=None if self._validation is None else rmse_on(fitted, self._validation),
            )
        )
