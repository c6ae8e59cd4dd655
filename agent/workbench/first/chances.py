"""How likely as much is explained where nothing happened: of events and of measured inputs, each once."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from agent.workbench.event_scan import course_p, instant_p
from agent.workbench.inputs.measured_input import MeasuredInput
from agent.workbench.library import happens_once

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agent.analysis.record.recording import FloatArray
    from agent.physics.effect import Effect, Facts
    from agent.workbench.hooks import Map
    from agent.workbench.predictor import Predictor
    from agent.workbench.step import Step
    from agent.workbench.trial import Optimum

STEPS_AND_EVENTS = 10
"""How often one staircase looks for what happened once: a load step and another gain, five steps."""


@dataclass(slots=True)
class Chances:
    """Of effects on top of the models of one record."""

    facts: Facts
    run: Map
    """Works on several at a time."""
    _known: dict[tuple[tuple[str, ...], str], float] = field(default_factory=dict)
    """By the effects of the model and that which is tried."""

    def of(self, smaller: Step | Optimum, effects: Sequence[Effect]) -> list[float]:
        """Return for each effect how likely as much is explained where nothing happened.

        0 of what is no event and no input. Of what happened once each candidate of each step has had its
        chance. No effect is fitted.
        """
        names = tuple(each.name for each in smaller.fit.model.effects)
        new = [each for each in effects if (names, each.name) not in self._known]
        tasks = [(smaller.predicts, each, self.facts) for each in new]
        for each, p in zip(new, self.run(_chance_of, tasks), strict=True):
            self._known[names, each.name] = p
        return [self._known[names, each.name] for each in effects]


def _chance_of(task: tuple[tuple[Predictor, FloatArray] | None, Effect, Facts]) -> float:
    predictions, effect, facts = task
    if predictions is None:
        return 0.0
    if isinstance(effect, MeasuredInput):
        return min(1.0, effect.inputs * course_p(*predictions, effect))
    return 0.0
