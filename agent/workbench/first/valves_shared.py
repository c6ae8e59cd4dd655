"""One valve for all effects of its family: each begins from that of the likeliest as well.

Effects of hysteresis are nearly the same valve with other numbers, and their errors have narrow minima, so
that a search may find one with the richer effect and miss it with the simpler one that is there. A scan looks
for others with the effect of most numbers, which has the valves of the simpler ones among its own; where it
finds a likelier one, the others begin from that.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from agent.physics.effects.hysteresis import HysteresisEffect
from agent.physics.foreign import EffectError
from agent.workbench.first.valve_scan import scanned
from agent.workbench.prediction_search import with_other_values
from agent.workbench.trial import predicted
from agent.workbench.valve_starts import ValveStart, with_valves

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

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
    scans: bool
    """Whether to scan as well."""


def to_seek(models: Mapping[str, Optimum]) -> dict[str, Seek]:
    """Return the effects of hysteresis, the likeliest among them, each with the valve to seek it from.

    ``models``: with each effect, the last of each.
    """
    valves = {
        name: model.predicts
        for name, model in models.items()
        if model.predicts is not None and isinstance(model.fit.model.effects[-1], HysteresisEffect)
    }
    if not valves:
        return {}
    valve = _valve(*valves[_likeliest(models, valves)])
    richest = max(valves, key=lambda name: len(models[name].fit.values))
    return {name: Seek(models[name], valve, name == richest) for name in valves}


def to_seek_again(models: Mapping[str, Optimum], before: Mapping[str, Seek]) -> dict[str, Seek]:
    """Return those that are to begin from the valve of another that has become likelier; mostly none.

    Args:
        models: After ``before``.
        before: Of ``to_seek``.
    """
    if not before:
        return {}
    likeliest = _likeliest(models, before)
    found = models[likeliest].predicts
    if found is None or models[likeliest] is before[likeliest].model:
        return {}
    valve = _valve(*found)
    return {name: Seek(models[name], valve, scans=False) for name in before if name != likeliest}


def _likeliest(models: Mapping[str, Optimum], names: Iterable[str]) -> str:
    def variance(name: str) -> float:
        found = models[name].predicts
        return math.inf if found is None else found[0].variance(found[1])

    return min(names, key=variance)


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
        if seek.scans:
            points = np.vstack((points, scanned(predicts.objective, points[0])))
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
