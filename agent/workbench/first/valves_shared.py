"""One valve for all effects of its family: each begins from that of the likeliest, and from a scan, as well.

Effects of hysteresis are nearly the same valve with other numbers, and their errors have narrow minima, so
that a search may find one with the richer effect and miss it with the simpler one that is there.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from agent.physics.effects.hysteresis import HysteresisEffect
from agent.physics.foreign import EffectError
from agent.workbench.first.valve_scan import scanned
from agent.workbench.prediction_search import with_other_values
from agent.workbench.valve_starts import ValveStart, with_valves

if TYPE_CHECKING:
    from collections.abc import Mapping

    from agent.analysis.record.recording import FloatArray
    from agent.workbench.fit import Fit
    from agent.workbench.predictor import Predictor
    from agent.workbench.trial import Optimum

Sought = tuple["Optimum", ValveStart]


def to_seek(models: Mapping[str, Optimum]) -> dict[str, Sought]:
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
    likeliest = min(valves, key=lambda name: valves[name][0].variance(valves[name][1]))
    valve = _valve(*valves[likeliest])
    return {name: (models[name], valve) for name in valves}


def sought(each: Sought) -> Fit | None:
    """Return a model where it predicts better with the process and the stem of a valve; None: nowhere."""
    model, valve = each
    if model.predicts is None:
        return None
    predicts, at = model.predicts
    effect = model.fit.model.effects[-1]
    if not isinstance(effect, HysteresisEffect):
        return None
    points = predicts.space.at(with_valves(model.fit, effect, (valve,), predicts.objective.facts))
    try:
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
