"""A load of edges has more harmonics than a search of its frequency needs: up to twice as many."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from agent.physics.effects.sinusoid import FASTEST
from agent.physics.effects.wave import RepeatingWave
from agent.workbench.fit import refit_from

if TYPE_CHECKING:
    from agent.workbench.fit import Fit
    from agent.workbench.record import Record


def with_more_harmonics(fitted: Fit, record: Record) -> Fit | None:
    """Return a model whose wave has twice as many harmonics, or as many as five samples allow, fitted again.

    None where it has no such wave, or one that is too fast for more.
    """
    model = fitted.model
    wave = next((each for each in model.effects if isinstance(each, RepeatingWave)), None)
    if wave is None:
        return None
    names = [name for name, _ in model.parameters(record.facts)]
    frequency = float(fitted.values[names.index(f"{wave.name}.frequency")])
    most = int(FASTEST / (frequency * record.facts.ts))
    if wave.harmonics >= most:
        return None
    more = replace(wave, harmonics=min(2 * wave.harmonics, most))
    larger = replace(model, effects=tuple(more if each is wave else each for each in model.effects))
    return refit_from(larger, record, fitted.values)
