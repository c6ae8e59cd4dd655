"""Goes on from a model of a file: adds its effects one after the other, fitted from its values."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from agent.workbench.fit import fit
from agent.workbench.saved_model import read_saved

if TYPE_CHECKING:
    from agent.workbench.session.bench import Bench


def add_saved(bench: Bench, mapping: object) -> None:
    """Add the effects of a saved model.

    Raises:
        ValueError: It is no saved model, of another loop or on another base, or has unknown effects.
    """
    model = read_saved(mapping)
    if model.loop != bench.window.loop:
        raise ValueError(f"the saved model is of the loop {model.loop}, not of {bench.window.loop}")
    if model.base != bench.base.name:
        raise ValueError(f"the saved model has the base {model.base}, not {bench.base.name}")
    for name in model.effects:
        bench.effect(name)  # reported before anything is fitted
    for name in model.effects:
        effect, smaller, record = bench.addable(name), bench.step.fit.model, bench.record
        larger = replace(smaller, effects=(*smaller.effects, model.as_saved(effect)))
        starts = model.values_of(larger, record.facts)[np.newaxis]
        bench.trials.progress(name, len(smaller.effects), len(model.effects))
        found = bench.trials.predicted(fit(larger, record, record.weight, starts))
        bench.take(bench.trials.with_all_harmonics(found), added=name)
