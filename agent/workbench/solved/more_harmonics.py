"""A load of edges has more harmonics than a search of its frequency needs: the model with twice as many."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from agent.physics.effects.wave import RepeatingWave
from agent.workbench.fit import refit_from

if TYPE_CHECKING:
    from agent.workbench.fit import Fit
    from agent.workbench.record import Record


FASTEST = 0.2
"""Frequency of the highest harmonic, one over samples."""


def with_more_harmonics(fitted: Fit, record: Record) -> Fit | None:
    """Return a model whose wave has twice as many harmonics, fitted again.

    None where it has no such wave, or one too fast: the highest harmonic needs five samples.
    """
    model = fitted.model
    wave = next((each for each in model.effects if isinstance(each, RepeatingWave)), None)
    if wave is None:
        return None
    more = replace(wave, harmonics=2 * wave.harmonics)
    names = [name for name, _ in model.parameters(record.facts)]
    frequency = float(fitted.values[names.index(f"{wave.name}.frequency")])
    if more.harmonics * frequency * record.facts.ts >= FASTEST:
        return None
    larger = replace(model, effects=tuple(more if each is wave else each for each in model.effects))
    return refit_from(larger, record, fitted.values)
