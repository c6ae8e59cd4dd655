"""Sticking valves that the project's quantifier finds in a record, as places for a fit to begin.

Over the whole record the error of a sticking valve is a needle in S and J that no scan of some hundred points
meets (design, fact 4); ``free_run`` follows it from a few periods to all.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.quantify.free_run.found import find
from agent.analysis.quantify.free_run.problem import pose
from agent.identify.objective import (
    BRISTLES,
    DELAY,
    J_RATIO,
    LEVEL,
    LOG_DAMPING,
    LOG_REST,
    LOG_SUPPLY,
    LOG_TAU,
    LOG_TAU2,
    S,
)
from agent.physics.valves.damped_stem import DampedStem
from agent.units import FrictionBands

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agent.analysis.record.recording import FloatArray, LoopWindow
    from agent.physics.effect import Facts
    from agent.physics.effects.hysteresis import HysteresisEffect
    from agent.workbench.fit import Fit

MOST = 8
"""Valves that are handed on."""
APART = 0.02
"""Least distance of two of them in S, part of OP's span, or ten times that in J/S."""


@dataclass(frozen=True, slots=True)
class ValveStart:
    """A valve and the process that it was found with."""

    bands: FrictionBands
    start: float
    """OP at the first slip less OP at the first sample, OP units."""
    stem: DampedStem
    process: dict[str, float]
    """``delay``, ``tau``, ``tau2``, s."""


def valve_starts(window: LoopWindow) -> tuple[ValveStart, ...]:
    """Return sticking valves that differ, the best first; none where none moves."""
    problem = pose(window)
    found = None if isinstance(problem, str) else find(window, problem)
    if isinstance(problem, str) or found is None:
        return ()
    kept: list[FloatArray] = []
    for fitted in (found.best, *found.others):
        valve = fitted.candidate
        near = any(
            abs(valve[S] - each[S]) < APART * problem.op_span
            and abs(valve[J_RATIO] - each[J_RATIO]) < 10 * APART
            for each in kept
        )
        if not near:
            kept.append(valve)
    return tuple(_start(each, float(problem.op[0]), window.ts) for each in kept[:MOST])


def _start(candidate: FloatArray, first_op: float, ts: float) -> ValveStart:
    s = float(candidate[S])
    process = {
        "delay": float(candidate[DELAY]) * ts,
        "tau": math.exp(candidate[LOG_TAU]) * ts,
        "tau2": math.exp(candidate[LOG_TAU2]) * ts,
    }
    bands = FrictionBands.from_s_j(s, float(candidate[J_RATIO]) * s)
    damping, supply, rest = (math.exp(candidate[each]) for each in (LOG_DAMPING, LOG_SUPPLY, LOG_REST))
    return ValveStart(
        bands,
        float(candidate[LEVEL]) - first_op,
        DampedStem(damping=damping, supply=supply, rest=rest, give=float(candidate[BRISTLES])),
        process,
    )


def with_valve(values: FloatArray, names: tuple[str, ...], valve: ValveStart) -> FloatArray:
    """Return ``values`` (k,) of parameters ``names`` with the process that ``valve`` was found with."""
    return np.array([valve.process.get(name, value) for name, value in zip(names, values, strict=True)])


def with_valves(
    fitted: Fit, stem: HysteresisEffect, valves: Sequence[ValveStart], facts: Facts
) -> FloatArray:
    """Return the values of a model with each of some valves in place of its own, own units, (m, k)."""
    names = tuple(name for name, _ in fitted.model.parameters(facts))
    own = np.array([name.startswith(f"{stem.name}.") for name in names])
    rows = []
    for valve in valves:
        row = with_valve(fitted.values, names, valve)
        row[own] = stem.values_of(valve.bands, valve.start, valve.stem, facts.ts)
        rows.append(row)
    return np.array(rows).reshape(-1, len(names))
