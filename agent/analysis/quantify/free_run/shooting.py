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

from agent.identify.objective import (
    IMPOSSIBLE,
    INTEGRATOR,
    LOG_TAU,
    Memory,
    Process,
    S,
    Valve,
    at_rest,
    block_mean,
    fit_gain,
    in_bounds,
    process_of,
    respond,
    valve_of,
)
from agent.identify.problem import Problem
from agent.jit import fused_kernel, kernel
from agent.physics.valves.damped_stem import Motion, stem_at, stem_motion, strokes

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray

OFFSETS = np.array([0.05, 0.2, 0.6])
"""How far from its rest a stem is set off first, parts of S; then halfway between, three times."""
HALVINGS = 3
TOO_LARGE = 1.5
"""Mean square of a shot's errors over the usual one from which the stem is set off."""
CHUNK = 16
"""Blocks after which a trial shot is given up if it is worse than the best; fewer cost more in calls."""
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
    """Room for the valve's way and its response, for a shot as it begins and for its trials."""

    position: FloatArray
    """OP units, (n,)."""
    response: FloatArray
    """OP units, (m,)."""
    rest_state: FloatArray
    """Of the stem, (5,)."""
    tried_position: FloatArray
    tried_state: FloatArray


@kernel
def track_for(problem: Problem) -> Track:
    """Return room for a record."""
    n, m = problem.op.size, problem.pv.size
    return Track(np.empty(n), np.empty(m), np.empty(5), np.empty(n), np.empty(5))


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


class Shot(NamedTuple):
    """One shot, as it stands where its stem rests."""

    t: int
    """Sample with which it goes on."""
    begin: int
    """First block that it moves."""
    state: FloatArray
    """Of the stem (``stem_at``), (5,)."""
    memory: Memory
    """Of the process."""
    valve: Valve
    motion: Motion
    process: Process


@kernel
def shoot(
    candidate: FloatArray, structure: int, problem: Problem, aim: Aim, shots: Shots, track: Track
) -> int:
    """Fill the track shot by shot and return how often the stem was set off."""
    block, m = problem.block, problem.pv.size
    n = m * block
    length = int(shots.periods * problem.period)
    valve = valve_of(candidate)
    process = process_of(candidate, structure, block, problem.keep, m)
    track.response[: process.whole] = 0.0
    state = stem_at(valve.x0, problem.op[0])
    motion = stem_motion(valve.damping, valve.supply, valve.rest, valve.give)
    t = move(valve, motion, problem, 0, n, state, track.position, block)
    memory = at_rest(track.position, block)
    begin = blocks_before(t, n, block)
    memory = respond(track.position, 0, begin, process, memory, track.response)
    count = 0
    while t < n:
        put(state, track.rest_state)
        shot = Shot(t, begin, track.rest_state, memory, valve, motion, process)
        next_t, end, memory = go_on(shot, state, length, problem, track)
        error = squares(track.response, begin, end, process, problem, aim)
        usual = aim.variance * (end - begin)
        price = shots.price * aim.variance
        if end - begin >= LEAST_BLOCKS and error > max(TOO_LARGE * usual, price) > 0.0:
            shift = best_shift(shot, end, candidate[S], error - price, problem, aim, track)
            if shift != 0.0:
                count += 1
                put(shot.state, state)
                state[0] += shift
                track.position[t - 1] = state[0]
                next_t, end, memory = go_on(shot, state, length, problem, track)
        begin, t = end, next_t
    return count


@kernel
def put(source: FloatArray, target: FloatArray) -> None:
    """Copy a few numbers; making slices of arrays would take longer."""
    for i in range(source.size):
        target[i] = source[i]


@kernel
def move(
    valve: Valve,
    motion: Motion,
    problem: Problem,
    begin: int,
    end: int,
    state: FloatArray,
    position: FloatArray,
    until: int,
) -> int:
    """Move a stem on from ``begin`` to ``end``, as ``strokes`` does, and return where it goes on."""
    bands = (valve.f_s, valve.f_s, valve.f_d)
    return strokes(problem.op, begin, end, state, bands, motion, position, until)


@kernel
def go_on(
    shot: Shot, state: FloatArray, length: int, problem: Problem, track: Track
) -> tuple[int, int, Memory]:
    """Move stem and process on to the first rest after ``length`` samples, into the track.

    Returns the sample and the block with which they go on, and the memory of the process then.
    """
    n = problem.pv.size * problem.block
    t = move(shot.valve, shot.motion, problem, shot.t, n, state, track.position, shot.t + length)
    end = blocks_before(t, n, problem.block)
    memory = respond(track.position, shot.begin, end, shot.process, shot.memory, track.response)
    return t, end, memory


@kernel
def blocks_before(t: int, n: int, block: int) -> int:
    """Return how many blocks end before the rest in sample t - 1; all at the end of the record."""
    return n // block if t >= n else (t - 1) // block


@kernel
def squares(
    response: FloatArray, begin: int, end: int, process: Process, problem: Problem, aim: Aim
) -> float:
    """Return the sum of squares that the blocks ``begin`` to ``end`` of the valve cause, PV units squared."""
    error = 0.0
    for b in range(begin + process.whole, min(end + process.whole, response.size)):
        error += ((aim.target[b] - aim.gain * response[b]) * problem.weight[b]) ** 2
    return error


@kernel
def best_shift(
    shot: Shot, end: int, s: float, least: float, problem: Problem, aim: Aim, track: Track
) -> float:
    """Return how far from its rest the stem best is, OP units, by the errors up to the block ``end``.

    0 where none of them is below ``least``. One loop without calls that take a record: it is where a search
    by shots spends its time, and handing over a dozen arrays takes as long as a trial.
    """
    op, block, target, weight, gain = problem.op, problem.block, aim.target, problem.weight, aim.gain
    position, state, process = track.tried_position, track.tried_state, shot.process
    bands = (shot.valve.f_s, shot.valve.f_s, shot.valve.f_d)
    for i in range(shot.begin * block, shot.t - 1):
        position[i] = track.position[i]
    best = centre = step = 0.0
    first_trials = 2 * OFFSETS.size
    for trial in range(first_trials + 2 * HALVINGS):
        if trial < first_trials:
            step = OFFSETS[trial // 2] * s
        elif best == 0.0:
            break
        elif trial % 2 == 0:
            step = 0.5 * (abs(best) if trial == first_trials else step)
            centre = best
        shift = centre + step if trial % 2 == 0 else centre - step
        put(shot.state, state)
        memory = shot.memory
        state[0] += shift
        t = shot.t
        position[t - 1] = state[0]
        error = 0.0
        last = shot.begin
        while last < end and error <= least:
            first, last = last, min(end, last + CHUNK)
            if last * block > t:
                strokes(op, t, last * block, state, bands, shot.motion, position, op.size)
                t = last * block
            of_chunk, memory = trial_squares(position, first, last, process, memory, target, gain, weight)
            error += of_chunk
        if error < least:
            best, least = shift, error
    return best


@fused_kernel
def trial_squares(
    position: FloatArray,
    begin: int,
    end: int,
    process: Process,
    memory: Memory,
    target: FloatArray,
    gain: float,
    weight: FloatArray,
) -> tuple[float, Memory]:
    """Return what ``squares`` does of blocks that ``respond`` would pass on, without keeping the response."""
    block, keep, pole, pole2 = process.block, process.keep, process.pole, process.pole2
    whole, now, then = process.whole, gain * process.now, gain * process.then
    passed, former, first, second = memory
    error = 0.0
    for b in range(begin, min(end, target.size - whole)):
        mean = block_mean(position, b, block)
        passed = keep * passed + (mean - former)
        former = mean
        first = pole * first + passed
        older = second
        second = pole2 * second + first
        error += ((target[b + whole] - now * second - then * older) * weight[b + whole]) ** 2
    return error, Memory(passed, former, first, second)


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
