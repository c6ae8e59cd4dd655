"""Which effects have the whole search, by their first fits."""

from __future__ import annotations

from typing import TYPE_CHECKING

from agent.physics.effects.sinusoid import Sinusoid
from agent.workbench.checks.lacking import LARGER_DYNAMICS
from agent.workbench.inputs.measured_input import MeasuredInput
from agent.workbench.shown.score import WORTH_A_FIT

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agent.physics.effect import Effect
    from agent.workbench.trial import Trial


def gaining(trials: Sequence[Trial]) -> list[Effect]:
    """Return the effects of whose family a first fit gains what is worth a whole one, and the best of all.

    And those of which it does not say: a wave, which an autoregression predicts; a measured input, which
    somebody named; all where there are no predictions; and beside what gains the larger dynamics, with which
    a check may explain what remains.
    """
    found = {each.effect.name: each.criterion for each in trials}
    families = {each.effect.family for each in trials if found[each.effect.name] > WORTH_A_FIT}
    names = {*(LARGER_DYNAMICS if families else ()), max(found, key=found.__getitem__, default="")}
    return [
        each.effect
        for each in trials
        if each.effect.family in families
        or each.effect.name in names
        or isinstance(each.effect, Sinusoid | MeasuredInput)
    ]


def gains(trial: Trial) -> bool:
    """Return whether a first fit gains what is worth a whole one; yes of a wave, of which it says little."""
    return trial.criterion > WORTH_A_FIT or isinstance(trial.effect, Sinusoid)
