"""Random steps of a valve.

S, J and the start of a valve move the error in steps, for only the instants of slip matter; and S trades off
with the delay, so that its steps go along that ridge.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from agent.identify.free_run_error import process_error
from agent.identify.objective import (
    BRISTLES,
    DELAY,
    FIRST,
    J_RATIO,
    LEVEL,
    LOG_DAMPING,
    LOG_REST,
    LOG_TAU,
    LOG_TAU2,
    RIGID,
    STEM_HIGH,
    STEM_LOW,
    S,
    in_bounds,
    valve_position,
)
from agent.identify.problem import Problem
from agent.jit import kernel
from agent.physics.valves.damped_stem import GIVE

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray


@kernel
def random_steps(
    start: FloatArray,
    error: float,
    scale: float,
    structure: int,
    problem: Problem,
    evaluations: int,
    rng: np.random.Generator,
) -> tuple[FloatArray, float]:
    """Return the best candidate met by an adaptive random search around ``start``, and its error.

    Steps shrink after ten failures in a row. A step of the process alone leaves the valve where it is. S
    trades off with the delay: half the steps in S go along.
    """
    samples_per_op = 0.0 if problem.fixed_delay > 0.0 else 1.0 / problem.op_speed
    best = start.copy()
    best_position = valve_position(best, problem)
    failures = 0
    for _ in range(evaluations):
        trial = best.copy()
        moves = rng.random() < 0.8
        if moves:
            disturb(trial, best, scale, problem.op_span, rng)
            if rng.random() < 0.5:
                trial[DELAY] -= (trial[S] - best[S]) * samples_per_op
        else:
            if problem.fixed_delay == 0.0:
                trial[DELAY] += 0.3 * scale * rng.standard_normal()
            trial[LOG_TAU] += 0.1 * scale * rng.standard_normal()
            trial[LOG_TAU2] += 0.2 * scale * rng.standard_normal()
        trial[DELAY] = max(trial[DELAY], 1.0)
        position = best_position
        if moves and in_bounds(trial, problem):
            position = valve_position(trial, problem)
        trial_error = process_error(position, trial, structure, problem)
        if trial_error < error:
            best, error, best_position = trial, trial_error, position
            failures = 0
        else:
            failures += 1
            if failures > 10:
                scale *= 0.7
                failures = 0
    return best, error


@kernel
def disturb(
    trial: FloatArray, best: FloatArray, scale: float, op_span: float, rng: np.random.Generator
) -> None:
    """Take a random step in the valve; ``scale`` 1 is 1.5 % of the OP span in S."""
    kind = rng.integers(0, 7 if best[LOG_REST] > RIGID else 5)
    s, j = best[S], best[S] * best[J_RATIO]
    if kind in (0, 1, 4):
        s += scale * 0.015 * op_span * rng.standard_normal()
    if kind == 1:
        j = s * best[J_RATIO]
    if kind in (2, 4):
        j += scale * 0.04 * op_span * rng.standard_normal()
    s = min(max(s, 0.002 * op_span), op_span)
    trial[S] = s
    trial[J_RATIO] = min(max(j / s, 0.0), 1.0)
    if kind in (0, 4):
        trial[LEVEL] += 0.5 * best[FIRST] * (s - best[S])
    if kind in (3, 4):
        trial[LEVEL] += scale * 0.015 * op_span * rng.standard_normal()
    if kind > 3 and best[LOG_REST] > RIGID:
        for axis in range(3):
            if kind in (4, 5 + axis % 2):
                moved = trial[LOG_DAMPING + axis] + 0.7 * scale * rng.standard_normal()
                trial[LOG_DAMPING + axis] = min(max(moved, STEM_LOW[axis]), STEM_HIGH[axis])
        if kind != 5 and best[BRISTLES] > 0.0:
            moved = best[BRISTLES] * np.exp(0.7 * scale * rng.standard_normal())
            trial[BRISTLES] = min(max(moved, GIVE[0]), GIVE[1])
