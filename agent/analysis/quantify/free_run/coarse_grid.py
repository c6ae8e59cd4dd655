"""Global stage: every (S, J/S, start) on a grid, each scored by a bank of first-order processes and delays.

Minima are needles, but the bank is cheap: with c(t) the reverse cumulative sum of PV filtered backward by a
pole, the covariance of PV with the delayed response is the sum over the valve's moves of move * c(t + delay).
Starts that lead to the same first slip, or that have met again after a sixth of the record, are one.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.quantify.free_run.objective import (
    DELAY,
    J_RATIO,
    LAG,
    LOG_TAU,
    LOG_TAU2,
    REST,
    SIZE,
    START,
    S,
)
from agent.analysis.quantify.free_run.problem import Problem, nuisance_basis
from agent.jit import kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from agent.analysis.recording import FloatArray

LONGEST = 2500
"""Samples looked at: longer records add needles to the haystack, not information at this resolution."""
S_STEPS = 160
J_RATIOS = np.array([0.0, 0.1, 0.25, 0.4, 0.55, 0.7, 0.85, 0.95, 1.0])
J_GROUPS = tuple(np.array(group) for group in ((0, 1), (2, 3), (4, 5), (6, 7, 8)))
STARTS = np.linspace(-0.999, 0.999, 33)
TAUS = 8
S_BINS = 25


def coarse_candidates(problem: Problem, stem: tuple[float, float], per_bin: int) -> FloatArray:
    """Return the ``per_bin`` best of each bin of S and J for one law of the valve, shape (k, 7).

    By bins, because the cells of one broad wrong basin would crowd out the needles.
    """
    s_values = np.linspace(0.004, 1.0, S_STEPS) * problem.op_span
    taus = np.geomspace(0.7, max(10.0, min(len(problem.op) / 3, 4 * problem.period)), TAUS)
    delays = bank_delays(problem)
    scores, places = score_grid(problem, stem, s_values, taus, delays)
    start = scores.argmax(axis=2)
    best = scores.max(axis=2)
    bins = (s_values / problem.op_span * S_BINS).astype(int)
    chosen = []
    for one_bin in np.unique(bins):
        rows = np.flatnonzero(bins == one_bin)
        for group in J_GROUPS:
            part = best[np.ix_(rows, group)]
            for _ in range(per_bin):
                row, column = np.unravel_index(np.argmax(part), part.shape)
                if part[row, column] <= 0:
                    break
                part[max(0, row - 1) : row + 2, column] = 0
                i, j = rows[row], group[column]
                r = start[i, j]
                tau, delay = divmod(places[i, j, r], len(delays))
                candidate = np.empty(SIZE)
                candidate[LOG_TAU] = math.log(taus[tau])
                candidate[LOG_TAU2] = math.log(0.2 * taus[tau])
                candidate[DELAY] = 1.0 + delays[delay]
                candidate[S], candidate[J_RATIO] = s_values[i], J_RATIOS[j]
                candidate[START], candidate[LAG], candidate[REST] = STARTS[r], *stem
                chosen.append(candidate)
    return np.array(chosen).reshape(-1, SIZE)


def bank_delays(problem: Problem) -> NDArray[np.int64]:
    """Delays of the bank beyond the one sample that is always there, samples, ascending."""
    if problem.fixed_delay > 0:
        return np.array([int(problem.fixed_delay) - 1])
    longest = 0.75 * problem.max_delay
    steps = np.concatenate([np.arange(4), np.geomspace(4, max(5.0, longest), 10)])
    return np.unique(np.round(steps).astype(np.int64))


def score_grid(
    problem: Problem,
    stem: tuple[float, float],
    s_values: FloatArray,
    taus: FloatArray,
    delays: NDArray[np.int64],
) -> tuple[FloatArray, NDArray[np.int64]]:
    """Return the explained share of PV, shape (S, J, start), and the place in the bank that reached it."""
    n = min(len(problem.op), LONGEST)
    line = nuisance_basis(np.ones(n), 0)  # gaps count as no deviation here: this only orders candidates
    pv = problem.pv[:n] - line @ (line.T @ problem.pv[:n])
    poles = np.exp(-1.0 / taus)
    # The start-up exp(-t/tau) made orthonormal to level and slope, for each pole.
    decay = poles[:, None] ** np.arange(n)
    on_line = decay @ line
    startup = decay - on_line @ line.T
    norm = 1.0 / np.sqrt(np.sum(startup**2, axis=1))
    startup *= norm[:, None]
    startup_pv = startup @ pv
    rest = pv - startup_pv[:, None] * startup
    bank = np.zeros((TAUS, n + int(delays[-1]) + 1))
    for i, pole in enumerate(poles):
        bank[i, :n] = backward_sums(rest[i], pole)
    return scan(
        np.ascontiguousarray(problem.op[:n]),
        bank,
        poles,
        delays,
        np.ascontiguousarray(line),
        on_line,
        norm,
        startup_pv**2,
        float(pv @ pv),
        s_values,
        J_RATIOS,
        STARTS,
        problem.gain_sign,
        stem[0],
        stem[1] * problem.op_span,
    )


@kernel
def backward_sums(pv: FloatArray, pole: float) -> FloatArray:
    """Return c(t), the sum from t on of PV filtered backward in time by a unit-gain pole, (n,)."""
    n = pv.size
    sums = np.empty(n)
    filtered = 0.0
    total = 0.0
    for t in range(n - 1, -1, -1):
        ahead = pv[t + 1] if t + 1 < n else 0.0
        filtered = pole * filtered + (1.0 - pole) * ahead
        total += filtered
        sums[t] = total
    return sums


@kernel
def first_slip(op: FloatArray, x0: float, f_s: float) -> int:
    """Return the sample of the first slip plus one, negative for a slip downward, 0 for none."""
    for t in range(op.size):
        if op[t] - x0 > f_s:
            return t + 1
        if x0 - op[t] > f_s:
            return -(t + 1)
    return 0


@kernel
def scan(
    op: FloatArray,
    bank: FloatArray,
    poles: FloatArray,
    delays: NDArray[np.int64],
    line: FloatArray,
    startup_on_line: FloatArray,
    startup_norm: FloatArray,
    startup_explains: FloatArray,
    pv_squares: float,
    s_values: FloatArray,
    j_ratios: FloatArray,
    starts: FloatArray,
    gain_sign: int,
    lag: float,
    rest: float,
) -> tuple[FloatArray, NDArray[np.int64]]:
    """Return scores and bank places of ``score_grid``; level and slope stand in ``line``, shape (n, 2)."""
    n = op.size
    taus = poles.size
    meet = n // 6
    scores = np.zeros((s_values.size, j_ratios.size, starts.size))
    places = np.zeros((s_values.size, j_ratios.size, starts.size), np.int64)
    moved_at = np.empty(n, np.int64)
    moved_by = np.empty(n)
    position = np.empty(n)
    met = np.empty(starts.size)
    # Sums of the response z, its square, and its products with the slope and the start-up, up to n - delay.
    sums = np.empty((4, taus, delays.size))
    for i_s in range(s_values.size):
        for i_j in range(j_ratios.size):
            f_s = s_values[i_s] * (1.0 + j_ratios[i_j]) / 2.0
            f_d = s_values[i_s] * (1.0 - j_ratios[i_j]) / 2.0
            former_slip = 0
            n_met = 0
            for i_r in range(starts.size):
                x0 = op[0] - starts[i_r] * f_s
                slip = first_slip(op, x0, f_s)
                if slip in (0, former_slip):
                    continue
                former_slip = slip
                moves = 0
                x = x0
                moving = 0.0
                known = False
                for t in range(n):
                    if not moving * (op[t] - moving * f_d - x) > 0.0:
                        moving = 0.0
                        if abs(op[t] - x) > f_s:
                            moving = 1.0 if op[t] > x else -1.0
                    if moving != 0.0:
                        balance = op[t] - moving * f_d
                        way = moving * (balance - x)
                        reached = balance - lag * (balance - x)
                        moved_at[moves] = t
                        moved_by[moves] = reached - x
                        moves += 1
                        x = reached
                        if way <= rest:
                            moving = 0.0
                    position[t] = x - x0
                    if t == meet:
                        for i in range(n_met):
                            known = known or abs(met[i] - x) <= lag * rest
                        if known:
                            break
                        met[n_met] = x
                        n_met += 1
                if known or moves < 3:
                    continue
                response_sums(position, poles, delays, line, sums)
                best = 0.0
                for i in range(taus):
                    for q in range(delays.size):
                        covariance = 0.0
                        for m in range(moves):
                            covariance += moved_by[m] * bank[i, moved_at[m] + delays[q]]
                        if covariance * gain_sign < 0.0:
                            continue
                        squares = sums[1, i, q]
                        level = line[0, 0] * sums[0, i, q]
                        # the delayed response meets the slope d samples later
                        slope = sums[2, i, q] + delays[q] * (line[1, 1] - line[0, 1]) * sums[0, i, q]
                        startup = startup_norm[i] * (
                            poles[i] ** delays[q] * sums[3, i, q]
                            - startup_on_line[i, 0] * level
                            - startup_on_line[i, 1] * slope
                        )
                        left = squares - level * level - slope * slope - startup * startup
                        if left <= 1e-6 * squares:
                            continue
                        score = (covariance * covariance / left + startup_explains[i]) / pv_squares
                        if score > best:
                            best = score
                            places[i_s, i_j, i_r] = i * delays.size + q
                scores[i_s, i_j, i_r] = best
    return scores, places


@kernel
def response_sums(
    position: FloatArray, poles: FloatArray, delays: NDArray[np.int64], line: FloatArray, sums: FloatArray
) -> None:
    """Fill ``sums`` (4, taus, delays) for all poles at once; ascending delays end the sums early."""
    n = position.size
    taus = poles.size
    z = np.zeros(taus)
    running = np.zeros((4, taus))
    startup = np.ones(taus)
    q = delays.size - 1
    for t in range(n + 1):
        while q >= 0 and t == n - delays[q]:
            sums[:, :, q] = running
            q -= 1
        if t == n:
            break
        slope = line[t, 1]
        for i in range(taus):
            zi = z[i]
            running[0, i] += zi
            running[1, i] += zi * zi
            running[2, i] += zi * slope
            running[3, i] += zi * startup[i]
            startup[i] *= poles[i]
            z[i] = zi + (1.0 - poles[i]) * (position[t] - zi)
