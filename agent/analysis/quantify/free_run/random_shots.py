"""Local search by the error of shots, which falls smoothly where that of the free run does not."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.quantify.free_run.climb import disturb
from agent.analysis.quantify.free_run.local_search import simplex
from agent.analysis.quantify.free_run.shooting import Aim, Shots, Track, aim_by, shot_error, track_for
from agent.identify.objective import DELAY, S, process_response
from agent.identify.problem import Problem
from agent.jit import kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from agent.analysis.record.recording import FloatArray

ROUNDS = 5
"""In which the shots of a start find their places."""
STRICTER = 0.6
"""What the mean square of an error is taken for in a round, over the round before."""
PROCESS_EVALUATIONS = 24
REST = 4
"""Least number of steps between two fits of the process."""
FAILURES = 12
"""In a row, after which the steps shrink."""
LEAST_SCALE = 0.03


@kernel
def random_shots(
    start: FloatArray,
    scale: float,
    step: FloatArray,
    axes: NDArray[np.int64],
    structure: int,
    problem: Problem,
    shots: Shots,
    evaluations: int,
    rng: np.random.Generator,
) -> tuple[FloatArray, float]:
    """Return the best candidate met around ``start`` and its error of shots; infinite out of bounds.

    The valve takes random steps; where one is an improvement, its process (``axes``, ``step``) is fitted to
    the way that the valve took. What the shots are judged by follows the best.
    """
    track = track_for(problem)
    best, aim, error = settled(start, step, axes, structure, problem, shots, track)
    if not np.isfinite(error):
        return best, error
    count = problem.weight.sum()
    samples_per_op = 0.0 if problem.fixed_delay > 0.0 else 1.0 / problem.op_speed
    failures = 0
    fitted = 0
    for i in range(evaluations):
        trial = best.copy()
        disturb(trial, best, scale, problem.op_span, rng)
        if rng.random() < 0.6:
            trial[DELAY] = max(1.0, trial[DELAY] - (trial[S] - best[S]) * samples_per_op)
        trial_error, shifts = shot_error(trial, structure, problem, aim, shots, track)
        if trial_error >= error:
            failures += 1
            if failures > FAILURES:
                scale = max(0.7 * scale, LEAST_SCALE)
                failures = 0
            continue
        failures = 0
        best, error = trial, trial_error
        aim = aim_by(track, best, structure, problem, aim.variance)
        if i - fitted >= REST and axes.size > 0:
            fitted = i
            trial, trial_aim = process_fitted(
                best, (0.3 * scale + 0.05) * step, axes, structure, problem, aim, track
            )
            trial_error, trial_shifts = shot_error(trial, structure, problem, trial_aim, shots, track)
            if trial_error <= error:
                best, error, shifts = trial, trial_error, trial_shifts
                aim = aim_by(track, best, structure, problem, aim.variance)
        usual = (error - shots.price * aim.variance * shifts) / count
        if usual < 0.8 * aim.variance:
            aim = Aim(aim.target, aim.gain, max(usual, 0.5 * aim.variance))
        error, _ = shot_error(best, structure, problem, aim, shots, track)
    return best, error


@kernel
def settled(
    start: FloatArray,
    step: FloatArray,
    axes: NDArray[np.int64],
    structure: int,
    problem: Problem,
    shots: Shots,
    track: Track,
) -> tuple[FloatArray, Aim, float]:
    """Return the start with its process fitted to shots that found their places, their aim and error."""
    candidate = start.copy()
    aim = Aim(problem.pv, 1.0, 0.0)
    error, _ = shot_error(candidate, structure, problem, aim, shots, track)
    if not np.isfinite(error):
        return candidate, aim, error
    count = problem.weight.sum()
    variance = error / count
    aim = aim_by(track, candidate, structure, problem, variance)
    for i in range(ROUNDS):
        variance *= STRICTER
        error, shifts = shot_error(
            candidate, structure, problem, Aim(aim.target, aim.gain, variance), shots, track
        )
        variance = max(variance, (error - shots.price * variance * shifts) / count)
        if i % 2 == 1 and axes.size > 0:
            candidate, aim = process_fitted(candidate, 0.5 * step, axes, structure, problem, aim, track)
        else:
            aim = aim_by(track, candidate, structure, problem, variance)
    aim = Aim(aim.target, aim.gain, variance)
    error, _ = shot_error(candidate, structure, problem, aim, shots, track)
    return candidate, aim, error


@kernel
def process_fitted(
    candidate: FloatArray,
    step: FloatArray,
    axes: NDArray[np.int64],
    structure: int,
    problem: Problem,
    aim: Aim,
    track: Track,
) -> tuple[FloatArray, Aim]:
    """Return the candidate with the process that fits the way its valve took, and the aim that follows."""
    fitted, _ = simplex(candidate, step, axes, track.position, structure, problem, PROCESS_EVALUATIONS)
    track.response[:] = process_response(track.position, fitted, structure, problem.block, problem.keep)
    return fitted, aim_by(track, fitted, structure, problem, aim.variance)
