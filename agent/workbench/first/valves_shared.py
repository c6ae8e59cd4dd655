"""One valve for all effects of its family: each begins from that of the likeliest as well.

Effects of hysteresis are nearly the same valve with other numbers, and their errors have narrow minima, so
that a search may find one with the richer effect and miss it with the simpler one that is there.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from agent.physics.effects.hysteresis import HysteresisEffect
from agent.physics.foreign import EffectError
from agent.workbench.prediction_search import with_other_values
from agent.workbench.trial import predicted
from agent.workbench.valve_starts import ValveStart, with_valves

if TYPE_CHECKING:
    from collections.abc import Mapping

    from agent.analysis.record.recording import FloatArray
    from agent.workbench.fit import Fit
    from agent.workbench.folds import Folds
    from agent.workbench.predictor import Predictor
    from agent.workbench.record import Record
    from agent.workbench.trial import Optimum, Tried


class Seek(NamedTuple):
    """What to look for with one effect of hysteresis."""

    model: Optimum
    """With the effect as its last."""
    valve: ValveStart
    """To begin from."""


def likeliest_valve(models: Mapping[str, Optimum]) -> str | None:
    """Return which effect of hysteresis makes a record likeliest; None where there are none.

    ``models``: with each effect, the last of each.
    """
    variances = {
        name: model.predicts[0].variance(model.predicts[1])
        for name, model in models.items()
        if model.predicts is not None and isinstance(model.fit.model.effects[-1], HysteresisEffect)
    }
    return min(variances, key=variances.__getitem__, default=None)


def to_seek(models: Mapping[str, Optimum], likeliest: str) -> dict[str, Seek]:
    """Return the other effects of hysteresis, each to be sought from the valve of the likeliest."""
    found = models[likeliest].predicts
    if found is None:
        return {}
    valve = _valve(*found)
    return {
        name: Seek(model, valve)
        for name, model in models.items()
        if name != likeliest and isinstance(model.fit.model.effects[-1], HysteresisEffect)
    }


def with_valve_of(each: tuple[Seek, Record, Folds]) -> Tried | None:
    """Return a model where it predicts better with the process and the stem of a valve; None: nowhere."""
    seek, record, folds = each
    fitted = _sought(seek)
    return None if fitted is None else predicted(fitted, record, folds)


def _sought(seek: Seek) -> Fit | None:
    model = seek.model
    if model.predicts is None:
        return None
    predicts, at = model.predicts
    effect = model.fit.model.effects[-1]
    if not isinstance(effect, HysteresisEffect):
        return None
    points = predicts.space.at(with_valves(model.fit, effect, (seek.valve,), predicts.objective.facts))
    try:
        found = with_other_values(predicts, at, points)
    except EffectError:  # of somebody else, at values that no fit before had; the model stays as it is
        return None
    return None if found is None else found[0].fit(found[1])


def _valve(predicts: Predictor, at: FloatArray) -> ValveStart:
    """Return the valve of the last effect of a model where it predicts best."""
    model, facts, values = predicts.objective.model, predicts.objective.facts, predicts.space.values(at)
    effect = model.effects[-1]
    if not isinstance(effect, HysteresisEffect):
        raise TypeError(f"{effect.name} is no hysteresis")
    names = [name for name, _ in model.parameters(facts)]
    own = len(effect.parameters(facts))
    bands, start, stem = effect.valve_of(values[len(values) - own :], facts.ts)
    shared = {name: float(value) for name, value in zip(names, values, strict=True) if "." not in name}
    return ValveStart(bands, start, stem, shared)
