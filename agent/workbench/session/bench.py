"""A recording and the models that were tried on it: compare, see where it fails, add, drop, undo."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from types import MappingProxyType
from typing import TYPE_CHECKING

from agent.physics.effects import effects as known_effects
from agent.workbench.fit import contributions, residual_of
from agent.workbench.hooks import Map, Progress, silent
from agent.workbench.inputs.measured_input import measured_inputs
from agent.workbench.library import applies, effect_named, library, missing
from agent.workbench.saved_model import saved
from agent.workbench.session import views
from agent.workbench.session.auto_base import based
from agent.workbench.session.compared_part import compared_part
from agent.workbench.session.opening import validation
from agent.workbench.session.other_base import other_base
from agent.workbench.step import Step, Verdict, step_of
from agent.workbench.verdict import naming, verdict_of

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray, LoopWindow
    from agent.physics.effect import Effect
    from agent.workbench.candidates import AllTried
    from agent.workbench.folds import Folds
    from agent.workbench.hypotheses import Decision
    from agent.workbench.record import Record
    from agent.workbench.residual.line_spectrum import LineSpectrum
    from agent.workbench.residual.where import Failure
    from agent.workbench.trial import Tried
    from agent.workbench.trials import Trials


NO_INPUTS: Mapping[str, FloatArray] = MappingProxyType({})


class Bench:
    """A recording, the models that were tried on it, and the way back."""

    def __init__(
        self,
        window: LoopWindow,
        base: str = "fopdt",
        validate: LoopWindow | None = None,
        without: Iterable[str] = (),
        *,
        effects: Sequence[Effect] | None = None,
        extra: Sequence[Effect] = (),
        inputs: Mapping[str, FloatArray] = NO_INPUTS,
        other_inputs: Mapping[str, FloatArray] = NO_INPUTS,
        run: Map = map,
        progress: Progress = silent,
    ) -> None:
        """Fit the base.

        Args:
            window: The recording.
            base: Name of the process that the model begins with; ``auto``: the likeliest.
            validate: Another recording of the same loop; every step is scored on it, nothing fitted. One on
                which nothing can be scored does no harm: ``not_validated`` says why.
            without: Effects or families that are not to be tried.
            effects: Built in and installed; None: ``agent.physics.effects.effects``.
            extra: Effects beside those.
            inputs: Measured inputs beside OP, each (n,), NaN where missing: candidates like any effect.
            other_inputs: The same of ``validate``.
            run: Tries effects, perhaps in parallel.
            progress: Called with what is tried next.

        Raises:
            ValueError: No such base, effect or family, or an input does not fit the recording.
        """
        window, inputs, self.part = compared_part(window, inputs)
        """Which samples of a very long recording are compared; None: all."""
        self.window = window
        self.base, found = based(window, base, run, progress)
        known = (*(known_effects() if effects is None else effects), *extra)
        names = {each.name for each in known}
        self.installed = (*known, *measured_inputs(inputs, other_inputs, len(window), names))
        self.library = library(self.installed, self.base, without)
        self.reason: str | None = None
        """In plain words why the recording is not testable; None where it is."""
        self._steps: list[Step] = []
        self._made: dict[tuple[object, ...], Step] = {}
        self._failures: dict[tuple[object, ...], tuple[Failure, ...]] = {}
        self._other_bases: dict[tuple[object, ...], tuple[str, ...]] = {}
        self._trials: Trials | None = None
        self._validation, self.not_validated = validation(validate, self.base, self.installed)
        """In plain words why nothing can be scored on the other recording; else, or without one, None."""
        if isinstance(found, str):
            self.reason = found
            return
        self._trials, base_alone = found
        self._trials.validation = self._validation
        self.take(base_alone)

    def use_hooks(self, run: Map, progress: Progress) -> None:
        """Work and report by other hooks from now on; what was tried is shared."""
        if self._trials is not None:
            self._trials = self._trials.with_hooks(run, progress)

    @property
    def trials(self) -> Trials:
        """What was tried on the recording.

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
        """Return PV less the newest model, PV units, (n,), NaN where PV has no weight."""
        return residual_of(self.step.fit, self.record)

    def where_it_fails(self) -> tuple[Failure, ...]:
        """Return the residual of the newest model against each physical axis, the largest share first."""
        return self.failures_of(self.step)

    def against(self, axis: str) -> tuple[FloatArray, FloatArray]:
        """Return an axis of ``where_it_fails`` and the residual that is tested against it, each (n,)."""
        return views.against(self.step, self.trials, axis)

    def failures_of(self, step: Step) -> tuple[Failure, ...]:
        """Return the same of any step of this session; it is computed once."""
        key = step.effects, step.rmse_fit
        if key not in self._failures:
            self._failures[key] = views.failures(step, self.trials)
        return self._failures[key]

    def other_base(self) -> tuple[str, ...]:
        """Return in words that another base does far better than the newest model, or nothing; once each."""
        key = self.step.effects, self.step.rmse_fit
        if key not in self._other_bases:
            self._other_bases[key] = other_base(self.window, self.base, self.step)
        return self._other_bases[key]

    def lines(self) -> LineSpectrum | None:
        """Return the spectrum of the residual of the newest model, with its lines; None where it has none."""
        return views.lines(self.step, self.trials)

    def candidates(self) -> Decision:
        """Try each effect that the newest model does not have, refitted with all else, and judge them.

        Raises:
            ValueError: The recording is not testable.
        """
        return self.tried().decision

    def tried(self) -> AllTried:
        """Try all on the newest model, fitted anew where a larger one shows it a deeper valley."""
        found = self.trials.all_on(self.step, self.library)
        better = self.trials.deeper(self.step, found)
        if better is not None:
            old = self._steps.pop()
            self.take(better, old.verdict, added=old.added, dropped=old.dropped)
            found = self.trials.all_on(self.step, self.library)
        return found

    def verdict_on(self, found: AllTried) -> Verdict:
        """Return what the newest model lacks by what was tried on it."""
        return verdict_of(self.step, found, self.where_it_fails(), self.lines(), self.record.facts)

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
        effect = self.addable(name)
        again = self._made.get(self._path(name, None))
        if again is not None:
            self._steps.append(again)
            return again
        found = self.trials.known(self.step)
        if found is None or name not in found.models:
            model = self.step.fit.model
            family = [each for each in missing(model, self.library) if each.family == effect.family]
            tried = family if effect in family else [*family, effect]
            found = self.trials.judged_on(self.step, tried, self.library)
        if name in self.trials.left_out:
            raise ValueError(self.trials.left_out[name])
        verdict = self.verdict_on(found)
        larger = self.trials.refined(found.models[name])
        if self.trials.is_worse(self.step.fit, larger.fit):  # the verdict is on the model that was tried
            larger = found.models[name]
        return self.take(larger, naming(verdict, name), added=name)

    def addable(self, name: str) -> Effect:
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
        again = self._made.get(self._path(None, name))
        if again is not None:
            self._steps.append(again)
            return again
        return self.take(self.trials.without(self.step.fit, name), dropped=name)

    def undo(self) -> Step:
        """Take back the last step, and return the one before.

        Raises:
            ValueError: There is only the base.
        """
        if len(self.staircase()) < 2:
            raise ValueError("there is no step to undo")
        self._steps.pop()
        return self.step

    def restore(self, steps: Iterable[Step]) -> None:
        """Go back to a staircase of this session."""
        self._steps = [*steps]

    def take(
        self,
        found: Tried,
        verdict: Verdict | None = None,
        *,
        added: str | None = None,
        dropped: str | None = None,
    ) -> Step:
        """Make a model that was tried the newest step, and return it."""
        before, run, record = self._steps[-1] if self._steps else None, self.trials.run, self.record
        step = step_of(
            found, record, self._validation, verdict, added=added, dropped=dropped, before=before, run=run
        )
        self._made[self._path(added, dropped)] = step
        self._steps.append(step)
        return step

    def _path(self, added: str | None, dropped: str | None) -> tuple[object, ...]:
        """Return the way from the base to a next step: who goes it again gets the same step, not refitted."""
        return (*((each.added, each.dropped) for each in self._steps), (added, dropped))

    def save(self) -> dict[str, object]:
        """Return the newest model as a mapping of plain values, for YAML or JSON.

        Raises:
            ValueError: The recording is not testable.
        """
        return saved(self.window.loop, self.step.fit.model, self.step.parameters)
