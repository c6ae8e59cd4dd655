"""The workbench: compare, see where it fails, learn what is missing, add it, watch the error fall."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from agent.physics.effects import effects as known_effects
from agent.physics.loop_model import LoopModel
from agent.workbench.automatic import add_all_confirmed
from agent.workbench.axes import physical_axes
from agent.workbench.candidates import naming, verdict_of
from agent.workbench.comparison import Comparison, not_testable
from agent.workbench.comparison_json import comparison_json
from agent.workbench.fit import contributions, fit, residual_of
from agent.workbench.folds import Folds, folds_of
from agent.workbench.hooks import Map, Progress, silent
from agent.workbench.library import applies, base_named, effect_named, library, missing
from agent.workbench.line_spectrum import LineSpectrum, line_spectrum
from agent.workbench.noise_floor import noise_floor
from agent.workbench.power import smallest_reduction
from agent.workbench.record import Record, bare_record, closed_by, record_of
from agent.workbench.saved_model import read_saved, saved
from agent.workbench.step import Step, Verdict, step_of
from agent.workbench.trials import Trials
from agent.workbench.where import Failure, where_it_fails

if TYPE_CHECKING:
    from agent.analysis.recording import FloatArray, LoopWindow
    from agent.physics.effect import Effect
    from agent.workbench.decision import Decision
    from agent.workbench.trial import Tried


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
            ValueError: No such base, effect or family, or nothing can be scored on ``validate``.
        """
        self.window = window
        self.base = base_named(base)
        self.installed = (*known_effects(), *extra)
        self.library = library(self.installed, self.base, without)
        self.reason: str | None = None
        """In plain words why nothing can be said about the recording; None where something can."""
        self._steps: list[Step] = []
        self._trials: Trials | None = None
        self._validation = None if validate is None else self._other(validate)
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
        self._trials = Trials(window, record, folds, run, tell)
        self.take(self.trials.predicted(fitted))

    @property
    def trials(self) -> Trials:
        """What was asked of the recording.

        Raises:
            ValueError: The recording is not testable; the text says why.
        """
        if self._trials is None:
            raise ValueError(f"{self.window.loop} cannot be tested: {self.reason}")
        return self._trials

    @property
    def step(self) -> Step:
        """The newest step; raises like ``trials``."""
        if not self._steps:
            raise ValueError(f"{self.window.loop} cannot be tested: {self.reason}")
        return self._steps[-1]

    @property
    def record(self) -> Record:
        """What the fits see."""
        return self.trials.record

    @property
    def folds(self) -> Folds:
        """Which samples were held out together."""
        return self.trials.folds

    def staircase(self) -> tuple[Step, ...]:
        """Return all steps, the base first; empty where the recording is not testable."""
        return tuple(self._steps)

    def compare(self) -> dict[str, FloatArray]:
        """Return PV of the newest model, of the base, and what each effect adds, PV units, each (n,)."""
        added = contributions(self.step.fit, self.record)
        return {"model": self.step.fit.pv, "base": self._steps[0].fit.pv, **added}

    def residual(self) -> FloatArray:
        """Return PV less the newest model, PV units, (n,), NaN where PV counts for nothing."""
        return residual_of(self.step.fit, self.record)

    def where_it_fails(self) -> tuple[Failure, ...]:
        """Return the residual of the newest model against each physical axis, the largest share first."""
        fitted, record = self.step.fit, self.record
        moved = any(each.stage == "valve" for each in fitted.model.effects)
        axes = physical_axes(
            record.op,
            record.facts.ts,
            record.period,
            position=fitted.model.position(record.op, fitted.values, record.facts) if moved else None,
            set_point=self.window.sp,
            start=self.window.start,
        )
        return where_it_fails(self.residual(), axes, self.trials.block, np.random.default_rng(0))

    def lines(self) -> LineSpectrum | None:
        """Return the spectrum of the residual of the newest model, with its lines; None where it has none."""
        return line_spectrum(self.residual(), self.record.op, self.record.facts.ts)

    def candidates(self) -> Decision:
        """Try each effect that the newest model does not have, refitted with all else, and judge them.

        Raises:
            ValueError: The recording is not testable.
        """
        return self.trials.all_on(self.step, self.library).decision

    def effect(self, name: str) -> Effect:
        """Return the effect of that name, in the library or not.

        Raises:
            ValueError: There is none; the text lists those that there are.
        """
        return effect_named(name, self.installed)

    def add(self, name: str) -> Step:
        """Add an effect, refit everything, and return the new step.

        Its verdict is that on the effect and its family, or on all candidates where they were tried.

        Raises:
            ValueError: No such effect; it is in the model, or does not apply to the base.
        """
        effect = self._addable(name)
        found = self.trials.known(self.step)
        if found is None or name not in found.models:
            model = self.step.fit.model
            family = [each for each in missing(model, self.library) if each.family == effect.family]
            found = self.trials.judged_on(self.step, family if effect in family else [*family, effect])
        verdict = verdict_of(found, self.where_it_fails(), self.lines())
        return self.take(found.models[name], naming(verdict, name), added=name)

    def _other(self, window: LoopWindow) -> Record:
        """Return another recording of the loop.

        Raises:
            ValueError: Nothing can be scored on it; the text says why.
        """
        closed = closed_by(window)
        if closed is not None:
            raise ValueError(f"{window.loop} cannot validate anything: {closed}")
        return bare_record(window, from_start=not self.base.linear)

    def _addable(self, name: str) -> Effect:
        """Return the effect of that name if the newest model may have it.

        Raises:
            ValueError: No such effect; it is in the model, or does not apply to the base.
        """
        effect = self.effect(name)
        if not applies(effect, self.base):
            raise ValueError(f"{name} does not apply to the base {self.base.name}")
        if effect not in missing(self.step.fit.model, [effect]):
            raise ValueError(f"{name} cannot be added to a model with {', '.join(self.step.effects)}")
        return effect

    def drop(self, name: str) -> Step:
        """Take an effect out, refit everything, and return the new step.

        Raises:
            ValueError: The model does not have it.
        """
        if name not in self.step.effects:
            raise ValueError(
                f"the model has no {name}; it has {', '.join(self.step.effects) or 'no effects'}"
            )
        return self.take(self.trials.without(self.step.fit, name), dropped=name)

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
        if self._steps:
            add_all_confirmed(self)
        return self.staircase()

    def take(
        self,
        found: Tried,
        verdict: Verdict | None = None,
        *,
        added: str | None = None,
        dropped: str | None = None,
    ) -> Step:
        """Make a model that was tried the newest step, and return it."""
        step = step_of(found, self.record, self._validation, verdict, added=added, dropped=dropped)
        self._steps.append(step)
        return step

    def save(self) -> dict[str, object]:
        """Return the newest model as a mapping of plain values, for YAML or JSON.

        Raises:
            ValueError: The recording is not testable.
        """
        return saved(self.window.loop, self.step.fit, self.record.facts)

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
        for name in model.effects:
            self.effect(name)  # told before anything is fitted
        for name in model.effects:
            effect = self._addable(name)
            larger = replace(self.step.fit.model, effects=(*self.step.fit.model.effects, effect))
            starts = model.values_of(larger, self.record.facts)[np.newaxis]
            self.trials.tell(name, len(self.step.effects), len(model.effects))
            fitted = fit(larger, self.record, self.record.weight, starts)
            self.take(self.trials.predicted(fitted), added=name)
        return self.staircase()

    def comparison(self) -> Comparison:
        """Return all that is known: the staircase, and what is said of the newest model."""
        if not self._steps:
            return not_testable(self.window.loop, str(self.reason))
        tried = self.trials.all_on(self.step, self.library)
        failures, lines = self.where_it_fails(), self.lines()
        candidates, losses = tried.decision.candidates, self.step.held_out.losses
        rng = np.random.default_rng(0)
        smallest = None
        if candidates:
            best = tried.models[candidates[0].effect].held_out.losses
            smallest = smallest_reduction(losses, best, len(candidates), rng)
        return Comparison(
            loop=self.window.loop,
            steps=self.staircase(),
            where_it_fails=failures,
            lines=() if lines is None else lines.from_outside,
            candidates=candidates,
            verdict=verdict_of(tried, failures, lines),
            noise_floor=noise_floor(self.residual(), losses, rng),
            smallest_percent=smallest,
            reason=None,
        )

    def result(self, recording: str | None = None) -> dict[str, object]:
        """Return the comparison as plain values: what ``slipjump compare --json`` prints."""
        return comparison_json(self.comparison(), recording or self.window.loop)
