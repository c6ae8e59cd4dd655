"""A model fitted to a record: free run from OP alone, everything at once, from many starts."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from agent.physics.bases.base import StartingBase
from agent.workbench.library import happens_once
from agent.workbench.objective import Pinned, objective_of, whitened
from agent.workbench.projection import nuisance_part, target_of
from agent.workbench.search import STEP, hypercube, lowered, searched, spread_about
from agent.workbench.space import space_of

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray
    from agent.identify.noise.autoregression import Innovations
    from agent.physics.loop_model import Layout, LoopModel
    from agent.workbench.objective import Objective
    from agent.workbench.projection import ProjectedPv, Solved
    from agent.workbench.record import Record
    from agent.workbench.space import Space

SCAN = 400
"""Points of the first scan."""
ROUNDS = ((8, STEP, 20), (3, STEP / 2, 40), (1, STEP / 5, 60))
NEAR = (STEP / 10, 40)
"""First step and evaluations for each parameter, where the values are known from almost the same samples."""
SHOWN = 0.05
"""Part of the squares by which the response moves in the record that samples must hold to show it. Nine loops
of ``simulators.draws.open_records`` leave 0.29 and more, but 0.008 where one block holds the only bump."""


@dataclass(frozen=True, slots=True)
class Fit:
    """A model with its numbers. Arrays over the record have shape (n,)."""

    model: LoopModel
    values: FloatArray
    """Of the parameters, own units, in the order of ``model.parameters``."""
    coefficients: FloatArray
    """Of the response (the gain, PV units per OP unit), then of the disturbances."""
    error: float
    """Sum of squares of the samples that count, PV units squared."""
    pv: FloatArray
    """Free run, PV units; level and drift are those of all the record, whatever the rest was fitted to."""
    at_bound: tuple[str, ...]
    """Parameters that ran into a bound."""


def fit(model: LoopModel, record: Record, weight: FloatArray, starts: FloatArray | None = None) -> Fit:
    """Fit a model to the samples that ``weight`` (n,) counts.

    Args:
        model: Base and effects.
        record: OP and PV.
        weight: 1 or 0.
        starts: Values (m, k), own units, to begin from besides the scan; None: only the scan.
    """
    objective = objective_of(model, record, target_of(record, weight, linear=model.base.linear))
    points = hypercube(SCAN, len(objective.space))
    if isinstance(model.base, StartingBase) and not model.effects:
        own = model.base.starts(record.op, record.pv, record.facts)
        points = np.vstack((objective.space.at(own), points))
    elif isinstance(model.base, StartingBase) and not model.base.linear:
        points = _spread_from_base(model.base, record, objective.space)
    if starts is not None:
        points = np.vstack((objective.space.at(starts), points))
    found = searched(objective, points, ROUNDS)
    return fit_at(model, record, objective.target, objective.space.values(found))


def nested_fit(known: FloatArray, model: LoopModel, record: Record, starts: FloatArray | None = None) -> Fit:
    """Fit a model that has one effect more than a smaller one, its last, to the whole record.

    Args:
        known: Values of the smaller model, (j,), own units: to begin from, as they are or a little off.
        model: Base and effects.
        record: OP and PV.
        starts: Values (m, k), own units, to begin from besides; None: there are none.
    """
    space = space_of(model, record.facts)
    nested = space.values(nested_starts(known, space))
    return fit(model, record, record.weight, nested if starts is None else np.vstack((starts, nested)))


def fit_from(model: LoopModel, record: Record, values: FloatArray) -> Fit:
    """Fit a model to the whole record from values near the best, (k,), own units; all move together."""
    objective = objective_of(model, record, target_of(record, record.weight, linear=model.base.linear))
    found = lowered(objective, objective.space.at(values), *NEAR)
    if isinstance(model.base, StartingBase) and not model.base.linear:
        # What a smaller model needed in place of the effect may be far from what this one needs.
        spread = _spread_from_base(model.base, record, objective.space)
        found = min(found, searched(objective, spread, ROUNDS), key=objective.error)
    return fit_at(model, record, objective.target, objective.space.values(found))


def _spread_from_base(base: StartingBase, record: Record, space: Space) -> FloatArray:
    return spread_from(base.starts(record.op, record.pv, record.facts), space)


def spread_from(own: FloatArray, space: Space) -> FloatArray:
    """Return points of the unit cube, (m, k): the base as in ``own`` (b, j), own units, all else spread."""
    points = hypercube(SCAN, len(space))
    values = space.values(points)
    values[:, : own.shape[1]] = own[np.arange(SCAN) % len(own)]
    return space.at(values)


def nested_starts(known: FloatArray, space: Space) -> FloatArray:
    """Return points of the unit cube, (m, k): the new parameters spread, the old as they are or a little off.

    Part of the delay that a smaller model needed may be the new effect's: the old go down more than up.
    """
    at = space.at(np.concatenate((known, space.values(np.zeros(len(space)))[len(known) :])))
    return spread_about(at, np.arange(len(space)) >= len(known), (-0.2, 0.1), SCAN)


def refit(fitted: Fit, record: Record, weight: FloatArray, noise: Innovations | None = None) -> Fit:
    """Fit the same model to other samples of its record, from the values that it has.

    By its free run, or with the autoregression of its residual, ``noise``, by its one-step predictions. By a
    simplex as well where the error is rough: slopes alone stay near the valve of the whole record, so that a
    held-out block was not quite held out (8 % less error with ``asymmetric_stiction``).

    When something happened once stays as it is, and how much it was where ``weight`` hides that instant: no
    other samples show it, and level and drift, too, are taken with the whole record in view. So does all that
    answers to OP where ``weight`` hides the moves of OP, as where one block holds the only bump.
    """
    model = fitted.model
    objective = objective_of(model, record, target_of(record, weight, linear=model.base.linear))
    if noise is not None:
        objective = whitened(objective, noise)
    once = {each.name for each in model.effects if happens_once(each, record.facts)}
    hidden, free = set(), []
    for (name, parameter), value in zip(model.parameters(record.facts), fitted.values.tolist(), strict=True):
        effect = name.partition(".")[0]
        stays = parameter.of_record and effect in once
        free.append(not stays)
        at = round(value / record.facts.ts)
        if stays and parameter.instant and not weight[min(at, len(weight) - 1)]:
            hidden.add(effect)
    # Where its instant is hidden nothing of an event is seen, nor its lag.
    names = objective.space.names
    free = [each and name.partition(".")[0] not in hidden for each, name in zip(free, names, strict=True)]
    owners = objective.layout.owners(record.op, fitted.values)
    at = objective.space.at(fitted.values)
    solved_for = np.array([each not in hidden for each in owners], dtype=np.bool_)
    if model.base.linear and not _moves(objective.layout, fitted.values, record, weight):
        solved_for[0] = False
        added = {each.name for each in model.effects if each.stage == "disturbance"}
        free = [each and name.partition(".")[0] in added for each, name in zip(free, names, strict=True)]
    pinned = Pinned(objective, at, np.array(free, dtype=np.bool_), fitted.coefficients, solved_for)
    found = lowered(pinned, pinned.at[pinned.free], *NEAR)
    return _fit_of(objective, objective.space.values(pinned.whole(found)), pinned.solved(found))


def _moves(layout: Layout, values: FloatArray, record: Record, weight: FloatArray) -> bool:
    """Return whether the response moves enough in samples of ``weight`` (n,) to be known from them."""
    response = layout.columns(record.op, values)[:, 0]
    seen, whole = (float(np.var(response[each > 0]) * np.sum(each > 0)) for each in (weight, record.weight))
    return seen > SHOWN * whole


def fit_at(model: LoopModel, record: Record, target: ProjectedPv, values: FloatArray) -> Fit:
    """Return the model with these values and the best coefficients for them."""
    objective = objective_of(model, record, target)
    return _fit_of(objective, values, objective.solved(objective.space.at(values)))


def refit_from(model: LoopModel, record: Record, values: FloatArray) -> Fit:
    """Return the model refitted from these values, (k,), own units, on all that counts."""
    target = target_of(record, record.weight, linear=model.base.linear)
    return refit(fit_at(model, record, target, values), record, record.weight)


def _fit_of(objective: Objective, values: FloatArray, solved: Solved) -> Fit:
    model, record = objective.model, objective.record
    explained = model.columns(record.op, values, record.facts) @ solved.coefficients
    drift = nuisance_part(record, explained, record.weight) if model.base.linear else 0.0
    return Fit(
        model=model,
        values=values,
        coefficients=solved.coefficients,
        error=solved.error,
        pv=explained + drift,
        at_bound=objective.space.at_bound(values),
    )


def residual_of(fitted: Fit, record: Record) -> FloatArray:
    """Return PV less the model, PV units, (n,), NaN where PV counts for nothing."""
    return np.where(record.weight > 0, record.pv - fitted.pv, np.nan)


def contributions(fitted: Fit, record: Record) -> dict[str, FloatArray]:
    """Return what each effect adds to the model's PV, PV units, (n,): the model less the one without it."""
    model = fitted.model
    space = [name.partition(".")[0] for name, _ in model.parameters(record.facts)]
    count = len(model.base.parameters(record.facts))
    columns = model.columns(record.op, fitted.values, record.facts) @ fitted.coefficients
    added = {}
    at = 1
    for effect in model.effects:
        kept = np.array([i < count or name != effect.name for i, name in enumerate(space)])
        rest = type(model)(model.base, tuple(each for each in model.effects if each.name != effect.name))
        without = rest.columns(record.op, fitted.values[kept], record.facts)
        coefficients = fitted.coefficients
        if effect.stage == "disturbance":
            width = len(coefficients) - without.shape[1]
            coefficients = np.delete(coefficients, slice(at, at + width))
            at += width
        added[effect.name] = columns - without @ coefficients
    return added
