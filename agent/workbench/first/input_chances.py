"""How likely a measured input explains as much where it does not act, each once."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from agent.workbench.event_scan import course_p
from agent.workbench.inputs.measured_input import MeasuredInput

if TYPE_CHECKING:
    from collections.abc import Iterable

    from agent.analysis.record.recording import FloatArray
    from agent.physics.effect import Effect
    from agent.workbench.hooks import Map
    from agent.workbench.predictor import Predictor
    from agent.workbench.step import Step
    from agent.workbench.trial import Optimum


@dataclass(slots=True)
class InputChances:
    """Of measured inputs on top of the models of one record."""

    run: Map
    """Works on several at a time."""
    _known: dict[tuple[tuple[str, ...], str], float] = field(default_factory=dict)
    """By the effects of the model and the input."""

    def of(self, smaller: Step | Optimum, effects: Iterable[Effect]) -> dict[str, float]:
        """Return by its name how likely each input explains as much, all inputs paid for; none is fitted.

        Effects that are no input have no place in it.
        """
        names = tuple(each.name for each in smaller.fit.model.effects)
        inputs = [each for each in effects if isinstance(each, MeasuredInput)]
        new = [each for each in inputs if (names, each.name) not in self._known]
        for each, p in zip(
            new, self.run(_chance_of, [(smaller.predicts, each) for each in new]), strict=True
        ):
            self._known[names, each.name] = p
        return {each.name: self._known[names, each.name] for each in inputs}


def _chance_of(task: tuple[tuple[Predictor, FloatArray] | None, MeasuredInput]) -> float:
    predictions, effect = task
    return 0.0 if predictions is None else min(1.0, effect.inputs * course_p(*predictions, effect))
