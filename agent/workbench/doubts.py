"""What speaks against an effect that would be confirmed; asked only then, for some of it takes long."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from agent.physics.effects.sinusoid import Sinusoid
from agent.workbench.checks.lacking import DYNAMICS, dominates, lacks_words, larger_dynamics
from agent.workbench.checks.own_cycle import WORDS as OWN_CYCLE
from agent.workbench.checks.own_cycle import keeps_time_of_loop
from agent.workbench.coincidence import LEVEL as COINCIDENT
from agent.workbench.coincidence import coincidence_p
from agent.workbench.fit import contributions
from agent.workbench.inputs.measured_input import MeasuredInput
from agent.workbench.likeliest import is_strong, less_likely
from agent.workbench.other_event import is_another_gain, is_only_another_level
from agent.workbench.residual.holm import LEVEL
from agent.workbench.residual.line_spectrum import CERTAIN_PART, line_spectrum
from agent.workbench.residual.state_dependence import failing, fails, state_dependence, still_fails
from agent.workbench.residual.very_strong import VERY_STRONG

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray
    from agent.workbench.decision import Decision
    from agent.workbench.evidence import Evidence
    from agent.workbench.fit import Fit
    from agent.workbench.predictor import Predictor
    from agent.workbench.residual.line_spectrum import LineSpectrum
    from agent.workbench.residual.state_dependence import Dependence
    from agent.workbench.step import Step
    from agent.workbench.trial import Tried


NOT_LOWER = "it does not lower the error where it was fitted"
ANSWERS = "the innovations do not fall: it repeats what the controller does"
UNLIKELY = "the record is far more likely with another effect"
STANDS_FOR_ANOTHER = "with it the model still fails as before: it stands for another cause"
WAVE = "it leaves a wave from outside that is most of the residual"
SLOW_NOISE = "slow noise makes such a wave as well"
BY_CHANCE = "the innovations show no such event: one as large appears by chance"
OTHER_EVENT = "what happened was of another kind"
"""What rejects an effect although it lowers the held-out error, in words for the user."""


def never(name: str, other: str) -> bool:  # noqa: ARG001
    """Return that nothing else helps."""
    return False


@dataclass(slots=True)
class Doubts:
    """Of the candidates on top of one model."""

    smaller: Step
    models: Mapping[str, Tried]
    """By the effect that was added, like ``found``."""
    found: Mapping[str, Evidence]
    null_p_of: Callable[[Fit], float]
    """How likely the effect of a fit seems to explain as much where it is not there."""
    both_needed: Callable[[str, str], bool]
    """Whether the record is far likelier with two of the effects than with either, and they explain it."""
    beside_dynamics: Callable[[str, str], bool] = never
    """Whether an effect is needed beside larger dynamics, the second, and both explain the record."""
    objections: dict[str, str] = field(default_factory=dict)
    """What rejects an effect, in words; ``of`` fills it."""
    lowered: dict[str, str] = field(default_factory=dict)
    """What makes an effect a suggestion at most, in words."""
    lacks: dict[str, str] = field(default_factory=dict)
    """What the model still lacks with an effect that is plainly there, in words."""
    _asked: set[str] = field(default_factory=set)
    _told: dict[str, Mapping[str, Dependence]] = field(default_factory=dict)

    def of(self, decision: Decision, null_p: Mapping[str, float]) -> dict[str, float]:
        """Return p that a decision's effect or a rival is not there; 1 where something speaks against it.

        Args:
            decision: With an effect.
            null_p: What was returned before.

        Returns:
            Only what is new; empty where no doubt is left to be asked.
        """
        effect = str(decision.effect)
        rivals = (effect, *decision.rivals)
        new = [each for each in rivals if each not in self._asked | null_p.keys()]
        self._asked.update(new)
        words = {each: self._objection(each) for each in new}
        doubts = self._rejected({each: word for each, word in words.items() if word is not None})
        for each in new:
            if self._is_another_event(each):
                less = dict.fromkeys(self._outdone_by_event(each), UNLIKELY)
                doubts.update(self._rejected({each: OTHER_EVENT, **less}))
        # Asked before rivals are compared: under a load that wanders the record may be likelier with what did
        # not happen than with what did.
        once = [each for each in new if self.found[each].once and each not in doubts]
        doubts.update({each: self.null_p_of(self.models[each].fit) for each in once})
        if any(p >= LEVEL for p in doubts.values()):
            return doubts
        criteria = {each: self.found[each].criterion for each in rivals}
        unlikely = less_likely(criteria)
        if unlikely:
            likeliest = max(rivals, key=criteria.__getitem__)
            if likeliest not in null_p.keys() | doubts.keys():
                # What is not there itself outdoes nothing.
                doubts[likeliest] = self.null_p_of(self.models[likeliest].fit)
                if doubts[likeliest] >= LEVEL:
                    return doubts
            return doubts | self._rejected(dict.fromkeys(unlikely, UNLIKELY))
        if decision.kind != "suggested" and effect not in null_p.keys() | doubts.keys():
            doubts[effect] = self.null_p_of(self.models[effect].fit)
        return doubts

    def is_complete(self, name: str) -> bool:
        """Return whether no axis tells any more that the model fails, with an effect."""
        return self.models[name].predicts is not None and not fails(self._dependence(name))

    def _rejected(self, words: Mapping[str, str]) -> dict[str, float]:
        """Keep what rejects each effect, and return p of each: 1."""
        self.objections.update(words)
        return dict.fromkeys(words, 1.0)

    def _objection(self, name: str) -> str | None:
        """Return what of the residual rejects an effect; None where nothing does."""
        if self._stands_for_another(name):
            return STANDS_FOR_ANOTHER
        if self._stands_for_a_wave(name):
            return WAVE
        if self._keeps_time_of_loop(name):
            self.lowered[name] = OWN_CYCLE
        return SLOW_NOISE if self._is_slow_noise(name) else None

    def _stands_for_another(self, name: str) -> bool:
        """Whether what made the smaller model fail is still there with an effect, and no other explains it.

        A wave that goes on all the time is seen by itself, whatever else is missing. What happened once and
        knows nothing of OP must leave nothing that hangs on OP.
        """
        evidence = self.found[name]
        left = self._leaves(name) if evidence.answers else set()
        if evidence.once and not evidence.answers:
            left = failing(self._dependence(name))
        if not left:
            return False
        self.lacks[name] = lacks_words(left)
        if any(self._is_missing_too(other, name) for other in self.models):
            return False
        if left <= DYNAMICS and any(
            self.beside_dynamics(name, other) for other in self._larger_dynamics(name)
        ):
            return False
        base, own = self.smaller.held_out.losses, self.models[name].held_out.losses
        if dominates(name, self.found, 1 - float(np.nansum(own) / np.nansum(base))):
            return False
        del self.lacks[name]
        return True

    def _larger_dynamics(self, name: str) -> tuple[str, ...]:
        family = self.found[name].family
        kin = {each for each, one in self.found.items() if one.family == family}
        return larger_dynamics(self.models, kin)

    def _keeps_time_of_loop(self, name: str) -> bool:
        """Whether an effect is a wave of a searched frequency that the loop may make itself."""
        predicts, effect = self.smaller.predicts, self.models[name].fit.model.effects[-1]
        if predicts is None or not isinstance(effect, Sinusoid):
            return False
        record = predicts[0].objective.record
        frequency = float(self.models[name].fit.values[-1])
        return keeps_time_of_loop(predicts[0].left(predicts[1]), record.op, frequency, record.facts.ts)

    def _stands_for_a_wave(self, name: str) -> bool:
        """Whether what answers OP leaves a wave that is most of what is left, and no candidate is that wave.

        OP holds the controller's answer to it, and so any lag or lead does something of what it does.
        """
        if not self.found[name].answers or not self._waves(name):
            return False
        return all(self._waves(other) for other, each in self.found.items() if not each.answers)

    def _waves(self, name: str) -> bool:
        """Return whether a wave from outside is most of what a model leaves, with an effect."""
        predicts = self.models[name].predicts
        if predicts is None:
            return False
        lines = _lines_left(*predicts)
        return lines is not None and any(each.part > CERTAIN_PART for each in lines.from_outside)

    def _is_another_event(self, name: str) -> bool:
        """Whether what seems to have happened once was of another kind.

        What knows nothing of OP did not happen just when moves of OP arrived, and does not what another gain
        does; another answer to OP does more than another level.
        """
        evidence, predicts = self.found[name], self.models[name].predicts
        if not evidence.once or predicts is None:
            return False
        if evidence.answers:
            return is_only_another_level(*predicts)
        return coincidence_p(*predicts) < COINCIDENT or is_another_gain(*predicts)

    def _outdone_by_event(self, name: str) -> list[str]:
        """Return what answers OP and is far less likely than what happened once, whatever kind that was of.

        None unless it did happen, and not by chance: a load that wanders has its own likelihood.
        """
        most = self.found[name].criterion
        less = [
            other
            for other, each in self.found.items()
            if each.answers and not each.once and most - each.criterion > VERY_STRONG
        ]
        return less if less and self.null_p_of(self.models[name].fit) < LEVEL else []

    def _is_slow_noise(self, name: str) -> bool:
        """Whether what goes on all the time, and was searched for, is a wave that slow noise makes, too."""
        evidence, predicts = self.found[name], self.smaller.predicts
        if evidence.answers or evidence.once or predicts is None:
            return False
        record, effect = predicts[0].objective.record, self.models[name].fit.model.effects[-1]
        if not effect.parameters(record.facts) or isinstance(effect, MeasuredInput):
            return False  # its course was not searched for
        lines = _lines_left(*predicts)
        wave = contributions(self.models[name].fit, record)[effect.name]
        return lines is not None and lines.may_be_slow_noise(wave, record.facts.ts)

    def _is_missing_too(self, name: str, beside: str) -> bool:
        """Whether an effect is another that is missing: strong, and what makes the smaller model fail.

        And needed as much with the one ``beside`` it, which else may stand for it.
        """
        own = self.found[name]
        return (
            own.family != self.found[beside].family
            and own.answers
            and not own.once
            and own.more
            and is_strong([own], len(self.models))
            and not self._leaves(name) & self._leaves(beside)
            and self.both_needed(name, beside)
        )

    def _leaves(self, name: str) -> set[str]:
        """Return the axes on which what made the smaller model fail is still there, with an effect."""
        return still_fails(self.smaller.estimate.dependence, self._dependence(name))

    def _dependence(self, name: str) -> Mapping[str, Dependence]:
        """Return what each axis tells of the model with an effect, once; empty where that cannot be asked."""
        if name not in self._told:
            predicts = self.models[name].predicts
            self._told[name] = {} if predicts is None else state_dependence(*predicts)
        return self._told[name]


def _lines_left(predicts: Predictor, best: FloatArray) -> LineSpectrum | None:
    """Return the lines in what a model leaves of PV where it predicts best."""
    record = predicts.objective.record
    return line_spectrum(predicts.left(best), record.op, record.facts.ts)
