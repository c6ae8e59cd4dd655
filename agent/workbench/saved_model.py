"""A model as a plain mapping, for a file and back."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from agent.physics.effects.load_step import TIMES, LoadStepEffect

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray
    from agent.physics.effect import Effect, Facts
    from agent.physics.loop_model import LoopModel
    from agent.workbench.certainty.intervals import FittedParameter

KIND = "slipjump model"


@dataclass(frozen=True, slots=True)
class SavedModel:
    """Base, effects and numbers of a model of one loop."""

    loop: str
    base: str
    effects: tuple[str, ...]
    values: Mapping[str, float]
    """By the full name of the parameter, own units."""

    def as_saved(self, effect: Effect) -> Effect:
        """Return an effect as the model has it: with as many steps of a load as it has instants."""
        if not isinstance(effect, LoadStepEffect):
            return effect
        steps = sum(f"{effect.name}.{each}" in self.values for each in TIMES)
        return replace(effect, steps=max(steps, 1))

    def values_of(self, model: LoopModel, facts: Facts) -> FloatArray:
        """Return the values of the parameters that ``model`` has, (k,).

        One that its effect had not yet when the model was saved has the value with which it does nothing.

        Raises:
            ValueError: one is missing, and none does nothing.
        """
        found = {name: self.values.get(name, each.null) for name, each in model.parameters(facts)}
        for name, value in found.items():
            if value is None:
                raise ValueError(f"the saved model has no value of {name}")
        return np.array([*found.values()])


def saved(loop: str, model: LoopModel, parameters: Iterable[FittedParameter]) -> dict[str, object]:
    """Return a model as a mapping of plain values: those that are printed, inside their intervals."""
    return {
        "kind": KIND,
        "loop": loop,
        "base": model.base.name,
        "effects": [each.name for each in model.effects],
        "parameters": {each.name: each.value for each in parameters},
    }


def read_saved(mapping: object) -> SavedModel:
    """Return the model of a mapping that ``saved`` made.

    Raises:
        ValueError: it is something else.
    """
    if not isinstance(mapping, Mapping) or mapping.get("kind") != KIND:
        raise ValueError(f"no saved model: 'kind: {KIND}' is missing")
    loop, base, effects = mapping.get("loop"), mapping.get("base"), mapping.get("effects")
    values = mapping.get("parameters")
    if not isinstance(loop, str) or not isinstance(base, str):
        raise ValueError("no saved model: loop and base must be names")  # noqa: TRY004 - text of a file
    if not isinstance(effects, list) or not all(isinstance(each, str) for each in effects):
        raise ValueError("no saved model: effects must be a list of names")
    if not isinstance(values, Mapping) or not all(_finite(each) for each in values.values()):
        raise ValueError("no saved model: parameters must be finite numbers")
    return SavedModel(loop, base, tuple(effects), {str(name): float(each) for name, each in values.items()})


def _finite(value: object) -> bool:
    return isinstance(value, (int, float)) and math.isfinite(value)
