"""Free run in shots: where a stretch of PV goes wrong, the stem may rest a little elsewhere before it.

Over a whole record the basin of the true valve is a needle, for a stem that stops a sample early or late
stands off for as long as it sticks. Here each stretch begins where the stem rests, and where PV tells that
it must have come to rest elsewhere, it is set off, at a price. So an error costs one stretch and not the rest
of the record, the error falls smoothly towards the true constants of the stem, and the fewer shots are set
off, the nearer the free run is. Multiple shooting (Bock, "Numerical treatment of inverse problems in chemical
reaction kinetics", Springer Series in Chemical Physics 18, 1981), of a state that is known but for its rests.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from agent.analysis.quantify.free_run.objective import (
    FIRST,
    IMPOSSIBLE,
    INTEGRATOR,
    J_RATIO,
    LEVEL,
    LOG_DAMPING,
    LOG_REST,
    LOG_SUPPLY,
    LOG_TAU,
    Process,
    S,
    at_rest,
    fit_gain,
    in_bounds,
    process_of,
    respond,
)
from agent.analysis.quantify.free_run.problem import Problem
from agent.jit import kernel
from agent.physics.valves.damped_stem import stem_at, strokes

if TYPE_CHECKING:
    from agent.analysis.recording import FloatArray

OFFSETS = np.array([0.05, 0.2, 0.6])
"""How far from its rest a stem is set off first, parts of S; then halfway between, three times."""
HALVINGS = 3
TOO_LARGE = 1.5
"""Mean square of a shot's errors over the usual one from which the stem is set off."""
CHUNK = 8
"""Blocks after which a trial shot is given up if it is worse than the best."""
LEAST_BLOCKS = 4


class Shots(NamedTuple):
    """How a record is shot."""

    periods: float
    """Least length of a shot, periods."""
    price: float
    """Of a stem that is set off, in mean squares of an error."""


class Aim(NamedTuple):
    """What shots are judged by, from the fit before."""

    target: FloatArray
    """PV less what is neither valve nor process, PV units, (m,)."""
    gain: float
    """PV units per OP unit."""
    variance: float
    """Mean square of an error, PV units squared; 0: no stem is set off."""


class Track(NamedTuple):
    """Room for the valve's way and its response, and for those of trials."""

    position: FloatArray
    """OP units, (n,)."""
    response: FloatArray
    """OP units, (m,)."""
    tried_position: FloatArray
    tried_response: FloatArray


@kernel
def track_for(problem: Problem) -> Track:
    """Return room for a record."""
    n, m = problem.op.size, problem.pv.size
    return Track(np.empty(n), np.empty(m), np.empty(n), np.empty(m))


@kernel
def shot_error(
    candidate: FloatArray, structure: int, problem: Problem, aim: Aim, shots: Shots, track: Track
) -> tuple[float, int]:
    """Return the sum of squares and the price of the stems set off, PV units squared, and their number.

    Infinite out of bounds. ``track`` keeps the valve's way and its response.
    """
    if not in_bounds(candidate, problem):
        return IMPOSSIBLE, 0
    count = shoot(candidate, structure, problem, aim, shots, track)
    error = fit_gain(track.response, candidate, structure, problem)[0]
    return max(0.0, error) + shots.price * aim.variance * count, count


@kernel
def shoot(
    candidate: FloatArray, structure: int, problem: Problem, aim: Aim, shots: Shots, track: Track
) -> int:
    """Fill the track shot by shot and return how often the stem was set off."""
    s = candidate[S]
    f_s, f_d = s * (1.0 + candidate[J_RATIO]) / 2.0, s * (1.0 - candidate[J_RATIO]) / 2.0
    bands = (f_s, f_s, f_d)
    stem = (
        math.exp(candidate[LOG_DAMPING]),
        math.exp(candidate[LOG_SUPPLY]),
        math.exp(candidate[LOG_REST]),
    )
    op, block, m = problem.op, problem.block, problem.pv.size
    n = m * block
    length = int(shots.periods * problem.period)
    process = process_of(candidate, structure, block, problem.keep, m)
    track.response[: process.whole] = 0.0
    state = stem_at(candidate[LEVEL] - candidate[FIRST] * f_s, op[0])
    t = strokes(op, 0, n, state, bands, stem, track.position, block)
    memory = at_rest(track.position, block)
    b = blocks_before(t, n, block)
    respond(track.position, 0, b, process, memory, track.response)
    count = 0
    while t < n:
        ahead, recalled = state.copy(), memory.copy()
        end = strokes(op, t, n, ahead, bands, stem, track.position, t + length)
        last = blocks_before(end, n, block)
        respond(track.position, b, last, process, recalled, track.response)
        error = squares(track.response, b, last, process, problem, aim, np.inf)
        usual = aim.variance * (last - b)
        if last - b >= LEAST_BLOCKS and error > max(TOO_LARGE * usual, shots.price * aim.variance) > 0.0:
            shift = best_shift(
                t,
                b,
                last,
                state,
                memory,
                s,
                error - shots.price * aim.variance,
                bands,
                stem,
                process,
                problem,
                aim,
                track,
            )
            if shift != 0.0:
                count += 1
                state[0] += shift
                track.position[t - 1] = state[0]
                ahead, recalled = state.copy(), memory.copy()
                end = strokes(op, t, n, ahead, bands, stem, track.position, t + length)
                last = blocks_before(end, n, block)
                respond(track.position, b, last, process, recalled, track.response)
        state, memory, b, t = ahead, recalled, last, end
    return count


@kernel
def blocks_before(t: int, n: int, block: int) -> int:
    """Return how many blocks end before the rest in sample t - 1; all at the end of the record."""
    return n // block if t >= n else (t - 1) // block


@kernel
def squares(
    response: FloatArray, begin: int, end: int, process: Process, problem: Problem, aim: Aim, limit: float
) -> float:
    """Return the sum of squares that the blocks ``begin`` to ``end`` of the valve cause.

    PV units squared; infinite above ``limit``.
    """
    error = 0.0
    for b in range(begin + process.whole, min(end + process.whole, response.size)):
        error += ((aim.target[b] - aim.gain * response[b]) * problem.weight[b]) ** 2
    return error if error <= limit else np.inf


@kernel
def best_shift(
    t: int,
    begin: int,
    end: int,
    state: FloatArray,
    memory: FloatArray,
    s: float,
    least: float,
    bands: tuple[float, float, float],
    stem: tuple[float, float, float],
    process: Process,
    problem: Problem,
    aim: Aim,
    track: Track,
) -> float:
    """Return how far from its rest in sample t - 1 the stem best is, OP units.

    0 where no error is below ``least``.
    """
    best = 0.0
    for part in OFFSETS:
        for shift in (part * s, -part * s):
            error = shifted(
                t, begin, end, state, memory, shift, least, bands, stem, process, problem, aim, track
            )
            if error < least:
                best, least = shift, error
    step = 0.5 * abs(best)
    for _ in range(HALVINGS if best != 0.0 else 0):
        centre = best
        for shift in (centre + step, centre - step):
            error = shifted(
                t, begin, end, state, memory, shift, least, bands, stem, process, problem, aim, track
            )
            if error < least:
                best, least = shift, error
        step *= 0.5
    return best


@kernel
def shifted(
    t: int,
    begin: int,
    end: int,
    state: FloatArray,
    memory: FloatArray,
    shift: float,
    limit: float,
    bands: tuple[float, float, float],
    stem: tuple[float, float, float],
    process: Process,
    problem: Problem,
    aim: Aim,
    track: Track,
) -> float:
    """Return the sum of squares of a shot with the stem set off, infinite once above ``limit``."""
    block = problem.block
    position, response = track.tried_position, track.tried_response
    moved, recalled = state.copy(), memory.copy()
    moved[0] += shift
    position[begin * block : t - 1] = track.position[begin * block : t - 1]
    position[t - 1] = moved[0]
    error = 0.0
    done = t
    for first in range(begin, end, CHUNK):
        last = min(end, first + CHUNK)
        if last * block > done:
            strokes(problem.op, done, last * block, moved, bands, stem, position, problem.op.size)
            done = last * block
        respond(position, first, last, process, recalled, response)
        error += squares(response, first, last, process, problem, aim, limit)
        if error > limit:
            return np.inf
    return error


@kernel
def aim_by(track: Track, candidate: FloatArray, structure: int, problem: Problem, variance: float) -> Aim:
    """Return what the next shots are judged by: gain, level, slope and start-up of the last ones."""
    m = problem.pv.size
    _, gain, start_up = fit_gain(track.response, candidate, structure, problem)
    pole = 0.0 if structure == INTEGRATOR else math.exp(-problem.block / math.exp(candidate[LOG_TAU]))
    memory = np.zeros(m)
    memory[0] = 0.0 if structure == INTEGRATOR else start_up
    for b in range(1, m):
        memory[b] = memory[b - 1] * pole
    memory *= problem.weight
    modelled = gain * track.response * problem.weight + memory
    return Aim(problem.pv - memory + problem.basis @ (problem.basis.T @ modelled), gain, variance)
