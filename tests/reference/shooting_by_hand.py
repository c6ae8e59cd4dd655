"""The free run in shots written for the eye: whole records for each trial, nothing given up early."""

import numpy as np
from agent.analysis.quantify.free_run.shooting import HALVINGS, LEAST_BLOCKS, OFFSETS, TOO_LARGE

from agent.identify.objective import (
    BRISTLES,
    DELAY,
    FIRST,
    J_RATIO,
    LEVEL,
    LOG_DAMPING,
    LOG_REST,
    LOG_SUPPLY,
    S,
)
from agent.physics.valves.damped_stem import stem_at, stem_motion, strokes
from tests.reference.free_run_twins import process_response


class Shooting:
    """One candidate on one record."""

    def __init__(self, candidate, structure, problem, aim, shots):
        self.candidate, self.structure, self.problem = candidate, structure, problem
        self.aim, self.shots = aim, shots
        self.f_s = candidate[S] * (1 + candidate[J_RATIO]) / 2
        self.f_d = candidate[S] * (1 - candidate[J_RATIO]) / 2
        self.stem = stem_motion(
            *(float(np.exp(candidate[axis])) for axis in (LOG_DAMPING, LOG_SUPPLY, LOG_REST)),
            float(candidate[BRISTLES]),
        )
        self.n = len(problem.pv) * problem.block
        block = problem.block
        self.late = int((candidate[DELAY] - 1) / block + (block + 1) / (2 * block))

    def move(self, position, state, t, until):
        """Return the way from sample t on, the stem at its end and the sample after."""
        position, state = position.copy(), state.copy()
        bands = (self.f_s, self.f_s, self.f_d)
        end = strokes(self.problem.op, t, self.n, state, bands, self.stem, position, until)
        return position, state, end

    def response(self, position):
        block, keep = self.problem.block, self.problem.keep
        return process_response(position[: self.n], self.candidate, self.structure, block, keep)

    def blocks(self, t):
        return (self.n if t >= self.n else t - 1) // self.problem.block

    def squares(self, position, first, last):
        """Of the errors of PV that the blocks ``first`` to ``last`` of the valve cause."""
        seen = slice(first + self.late, last + self.late)
        error = self.aim.target[seen] - self.aim.gain * self.response(position)[seen]
        return np.sum((error * self.problem.weight[seen]) ** 2)

    def run(self):
        """Return the response and how many stems were set off."""
        problem, shots, variance = self.problem, self.shots, self.aim.variance
        length = int(shots.periods * problem.period)
        state = stem_at(self.candidate[LEVEL] - self.candidate[FIRST] * self.f_s, problem.op[0])
        position, state, t = self.move(np.zeros(len(problem.op)), state, 0, problem.block)
        count = 0
        while t < self.n:
            way, ahead, end = self.move(position, state, t, t + length)
            first, last = self.blocks(t), self.blocks(end)
            error = self.squares(way, first, last)
            bad = error > max(TOO_LARGE * variance * (last - first), shots.price * variance) > 0
            if bad and last - first >= LEAST_BLOCKS:
                shift = self.best_shift(position, state, t, (first, last), error - shots.price * variance)
                if shift != 0:
                    count += 1
                    way, ahead, end = self.move(*self.set_off(position, state, t, shift), t, t + length)
            position, state, t = way, ahead, end
        return self.response(position), count

    def set_off(self, position, state, t, shift):
        position, state = position.copy(), state.copy()
        state[0] += shift
        position[t - 1] = state[0]
        return position, state

    def best_shift(self, position, state, t, seen, least):
        best, s = 0.0, self.candidate[S]

        def error(shift):
            return self.squares(self.move(*self.set_off(position, state, t, shift), t, self.n)[0], *seen)

        for shift in [sign * part * s for part in OFFSETS for sign in (1, -1)]:
            if error(shift) < least:
                best, least = shift, error(shift)
        step = abs(best) / 2
        for _ in range(HALVINGS if best else 0):
            centre = best
            for shift in (centre + step, centre - step):
                if error(shift) < least:
                    best, least = shift, error(shift)
            step /= 2
        return best
