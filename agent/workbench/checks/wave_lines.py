"""What rejects a wave: the residual without it has no line there, or its harmonics gain nothing.

Of many frequencies one goes along with slow noise over a whole record, held-out blocks as well: what a search
found is a wave only where the spectrum has a line that noise does not explain, or the innovations show it as
``line_of`` says. An autoregression predicts a slow wave, so that they may hardly fall with it: where there is
a line they say nothing against it. Nor do they prove a slow one: thirty lags do not distinguish a cycle of
some hundred samples from other slow noise.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from agent.physics.effects.sinusoid import Sinusoid
from agent.physics.effects.wave import HARMONICS as MULTIPLES
from agent.physics.effects.wave import RepeatingWave
from agent.workbench.checks.own_cycle import near
from agent.workbench.residual.holm import LEVEL
from agent.workbench.residual.line_spectrum import CERTAIN_CYCLES, line_spectrum
from agent.workbench.residual.very_strong import VERY_STRONG

if TYPE_CHECKING:
    from collections.abc import Mapping

    from agent.analysis.record.recording import FloatArray
    from agent.workbench.evidence import Evidence
    from agent.workbench.fit import Fit
    from agent.workbench.predictor import Predictor
    from agent.workbench.trial import Optimum

SLOW = "the innovations do not fall: what PV was just before says as much"
NO_LINE = "the residual has no line there: slow noise goes along with some wave"
SLOW_LINE = "slow noise makes such a line as well"
NO_HARMONICS = "its harmonics gain nothing: it is a sinusoid"

WaveLine = Literal["certain", "slow", "none"]
"""``slow``: slow noise may have made it."""
UNCERTAIN: frozenset[WaveLine | None] = frozenset({"slow", "none"})


def wave_objections(
    smaller: tuple[Predictor, FloatArray] | None,
    models: Mapping[str, Optimum],
    found: Mapping[str, Evidence],
) -> dict[str, str]:
    """Return what speaks against waves, in words; ``SLOW_LINE`` makes one a suggestion.

    Args:
        smaller: Predictions of the model without them, and where they are best; None: not known.
        models: With each effect.
        found: What the innovations say of each.
    """
    objections = {}
    waves = {name: each.fit for name, each in models.items() if is_wave(each.fit)}
    pure = [found[name].criterion for name, each in waves.items() if is_pure(each)]
    for name, wave in waves.items():
        line, criterion = line_of(smaller, wave, found[name].by_chance), found[name].criterion
        harmonics = _has_harmonics(wave)
        if line in UNCERTAIN:
            objections[name] = SLOW_LINE if line == "slow" else NO_LINE
        elif harmonics and pure and criterion - pure[0] <= VERY_STRONG:
            objections[name] = NO_HARMONICS
        elif criterion < 0.0 and (line is None or harmonics):
            objections[name] = SLOW
    return objections


def is_wave(larger: Fit) -> bool:
    """Return whether the last effect of a fit is a wave."""
    return isinstance(larger.model.effects[-1], Sinusoid)


def is_pure(larger: Fit) -> bool:
    """Return whether the last effect of a fit is a wave without harmonics: an autoregression predicts it."""
    return is_wave(larger) and not _has_harmonics(larger)


def line_of(
    smaller: tuple[Predictor, FloatArray] | None, larger: Fit, by_chance: float = 1.0
) -> WaveLine | None:
    """Return which line the residual without a wave has there; None: not known.

    One of the harmonics of a wave is enough. The innovations may show a wave as well: one that is not slow,
    for between two lines of the spectrum it is lower than on one, or one with harmonics, which slow noise has
    not.

    Args:
        smaller: Predictions of the model without the wave, and where they are best; None: not known.
        larger: The model with it.
        by_chance: How likely the innovations fall as far without a wave, all frequencies paid for.
    """
    if smaller is None or not is_wave(larger):
        return None
    predicts, best = smaller
    record, harmonics = predicts.objective.record, _has_harmonics(larger)
    frequency, duration = float(larger.values[-1]), record.facts.duration
    if by_chance < LEVEL and (harmonics or frequency * duration >= CERTAIN_CYCLES):
        return "certain"
    found = line_spectrum(predicts.left(best), record.op, record.facts.ts)
    if found is None:
        return None  # there are gaps
    multiples = range(1, 1 + (MULTIPLES if harmonics else 1))
    if any(near(found.certain, multiple * frequency, duration) for multiple in multiples):
        return "certain"
    return "slow" if near(found.lines, frequency, duration) else "none"


def _has_harmonics(larger: Fit) -> bool:
    return isinstance(larger.model.effects[-1], RepeatingWave)
