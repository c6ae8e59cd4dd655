"""A load of edges has more harmonics than a search of its frequency needs: the models that have more."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from agent.physics.effects.sinusoid import FASTEST
from agent.physics.effects.wave import RepeatingWave
from agent.workbench.fit import fit_at
from agent.workbench.projection import target_of

if TYPE_CHECKING:
    from agent.workbench.fit import Fit
    from agent.workbench.record import Record

MOVES = 0.5
"""By how many lines of the spectrum a fit of more harmonics may move the frequency: a bound of it must not
lie nearer."""


def with_more_harmonics(fitted: Fit, record: Record) -> list[Fit]:
    """Return models whose wave has two, four, ... times as many harmonics, or as many as five samples allow.

    All else is as in the model, but for what is solved for. Empty where it has no wave with harmonics, or
    one that is too fast for more.
    """
    model = fitted.model
    wave = next((each for each in model.effects if isinstance(each, RepeatingWave)), None)
    if wave is None:
        return []
    names = [name for name, _ in model.parameters(record.facts)]
    frequency = float(fitted.values[names.index(f"{wave.name}.frequency")])
    moves = MOVES / record.facts.duration
    most = int(FASTEST / ((frequency + moves) * record.facts.ts))
    target = target_of(record, record.weight, linear=model.base.linear)
    larger, harmonics = [], wave.harmonics
    while harmonics < most:
        harmonics = min(2 * harmonics, most)
        more = replace(wave, harmonics=harmonics)
        effects = tuple(more if each is wave else each for each in model.effects)
        larger.append(fit_at(replace(model, effects=effects), record, target, fitted.values))
    return larger
