"""Error of a free run that a few wrong slips do not spoil, for the search of the valve.

One slip missed or too many displaces the stem until the next reversal. Near the true valve most half periods
are right and a few are far off, so that least squares sees a needle a quarter per cent wide. The geometric
mean over half periods of their mean squared errors sees the many that are right: its basin is some per cent
wide.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.quantify.free_run.climb import disturb
from agent.analysis.quantify.free_run.objective import (
    DELAY,
    IMPOSSIBLE,
    LOG_TAU,
    LOG_TAU2,
    S,
    in_bounds,
    process_response,
    valve_position,
)
from agent.analysis.quantify.free_run.problem import Problem
from agent.jit import kernel, summing_kernel

if TYPE_CHECKING:
    from agent.analysis.recording import FloatArray

FLOOR = 5e-4
"""Share of the variance of PV under which a half period counts as right."""
REWEIGHTINGS = 3


@summing_kernel
def half_period_sums(response: FloatArray, problem: Problem, length: int, sums: FloatArray) -> None:
    """Fill ``sums`` (segments, 6): counts and sums of r, y, r r, r y, y y over each half period."""
    for segment in range(sums.shape[0]):
        count = r_sum = y_sum = rr = ry = yy = 0.0
        for t in range(segment * length, (segment + 1) * length):
            w = problem.weight[t]
            r = response[t] * w
            y = problem.pv[t]
            count += w
            r_sum += r
            y_sum += y
            rr += r * r
            ry += r * y
            yy += y * y
        sums[segment, 0] = count
        sums[segment, 1] = r_sum
        sums[segment, 2] = y_sum
        sums[segment, 3] = rr
        sums[segment, 4] = ry
        sums[segment, 5] = yy


@kernel
def geometric_error(sums: FloatArray, gain_sign: int) -> float:
    """Return the geometric mean of the half periods' errors, over the variance of PV."""
    segments = sums.shape[0]
    variance = np.sum(sums[:, 5]) / np.sum(sums[:, 0])
    floor = FLOOR * variance
    weight = np.ones(segments)
    loss = IMPOSSIBLE
    for _ in range(REWEIGHTINGS):
        n = r = y = rr = ry = 0.0
        for s in range(segments):
            w = weight[s]
            n += w * sums[s, 0]
            r += w * sums[s, 1]
            y += w * sums[s, 2]
            rr += w * sums[s, 3]
            ry += w * sums[s, 4]
        spread = rr - r * r / n
        if not spread > 1e-9 * rr:
            return IMPOSSIBLE
        gain = (ry - r * y / n) / spread
        if gain * gain_sign < 0.0:
            gain = 0.0
        level = (y - gain * r) / n
        total = 0.0
        count = 0.0
        for s in range(segments):
            if sums[s, 0] > 0.0:
                squares = (
                    sums[s, 5]
                    + gain * gain * sums[s, 3]
                    + level * level * sums[s, 0]
                    - 2.0 * gain * sums[s, 4]
                    - 2.0 * level * sums[s, 2]
                    + 2.0 * gain * level * sums[s, 1]
                )
                error = max(squares / sums[s, 0], 0.0) + floor
                total += sums[s, 0] * math.log(error)
                count += sums[s, 0]
                weight[s] = 1.0 / error
            else:
                weight[s] = 0.0
        loss = math.exp(total / count) / variance
    return loss


@kernel
def candidate_error(
    candidate: FloatArray, structure: int, problem: Problem, length: int, sums: FloatArray
) -> float:
    """Return the geometric error of a candidate's free run; infinite out of bounds."""
    if not in_bounds(candidate, problem):
        return IMPOSSIBLE
    position = valve_position(candidate, problem)
    response = process_response(position, candidate, structure, problem.block, problem.keep)
    half_period_sums(response, problem, length, sums)
    return geometric_error(sums, problem.gain_sign)


@kernel
def descend(
    start: FloatArray,
    structure: int,
    problem: Problem,
    scale: float,
    evaluations: int,
    rng: np.random.Generator,
) -> tuple[FloatArray, float]:
    """Return the best candidate met by an adaptive random search, and its geometric error."""
    samples_per_op = 0.0 if problem.fixed_delay > 0.0 else 1.0 / problem.op_speed
    length = max(3, int(problem.period / problem.block / 2.0))
    sums = np.empty((problem.pv.size // length, 6))
    best = start.copy()
    error = candidate_error(best, structure, problem, length, sums)
    failures = 0
    for _ in range(evaluations):
        trial = best.copy()
        if rng.random() < 0.75:
            disturb(trial, best, scale, problem.op_span, rng)
            if rng.random() < 0.4:
                trial[DELAY] -= (trial[S] - best[S]) * samples_per_op
        else:
            if problem.fixed_delay == 0.0:
                trial[DELAY] += scale * max(0.5, 0.01 * problem.period) * rng.standard_normal()
            trial[LOG_TAU] += 0.3 * scale * rng.standard_normal()
            trial[LOG_TAU2] += 0.4 * scale * rng.standard_normal()
        trial[DELAY] = max(trial[DELAY], 1.0)
        trial_error = candidate_error(trial, structure, problem, length, sums)
        if trial_error < error:
            best, error = trial, trial_error
            failures = 0
        else:
            failures += 1
            if failures > 12:
                scale *= 0.7
                failures = 0
    return best, error
