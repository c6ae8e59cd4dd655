"""The kernels of ``free_run`` written for the eye: one regressor a column, NumPy's least squares."""

import numpy as np
from scipy.signal import lfilter

from agent.analysis.quantify.free_run.objective import (
    DELAY,
    INTEGRATOR,
    J_RATIO,
    LAG,
    LOG_TAU,
    LOG_TAU2,
    REST,
    SOPDT,
    START,
    S,
)
from tests.reference.damped_stem_branches import damped_stem_branches


def valve(stem, op, f_s, f_d, x0):
    """Return the positions; ``stem`` is lag and rest, rest over the span of OP."""
    lag, rest = stem
    return np.array(damped_stem_branches(op, f_s, f_d, x0, lag, rest * np.ptp(op)))


def bands(s, j_ratio):
    return s * (1 + j_ratio) / 2, s * (1 - j_ratio) / 2


def valve_position(candidate, op):
    f_s, f_d = bands(candidate[S], candidate[J_RATIO])
    return valve((candidate[LAG], candidate[REST]), op, f_s, f_d, op[0] - candidate[START] * f_s)


def first_order(values, tau):
    """Unit gain, at rest at zero before the first sample; it answers in the same sample."""
    pole = np.exp(-1 / tau)
    return lfilter([1 - pole], [1, -pole], values)


def process_response(position, candidate, structure):
    tau, tau2 = np.exp(candidate[LOG_TAU]), np.exp(min(candidate[LOG_TAU2], candidate[LOG_TAU]))
    if structure == INTEGRATOR:
        rest = 0.0
        moved = np.cumsum(position - position.mean())
    else:
        rest = position[0] - position.mean()
        moved = first_order(position - position[0], tau)
        if structure == SOPDT:
            moved = first_order(moved, tau2)
    t = np.arange(len(position))
    answer = rest + np.concatenate([[0.0], moved[:-1]])  # one sample of delay is always there
    return np.interp(t - (candidate[DELAY] - 1), t, answer, left=rest)


def startup(n, candidate, structure):
    """The process' own state before the record dies away; an integrator has none, level is its state."""
    if structure == INTEGRATOR:
        return np.zeros(n)
    samples_since_the_delay = np.maximum(0, np.arange(n) - np.ceil(candidate[DELAY] - 1))
    return np.exp(-samples_since_the_delay / np.exp(candidate[LOG_TAU]))


def squares(columns, pv):
    """Return the least sum of squares of pv minus a combination of the columns, and the combination."""
    weights, *_ = np.linalg.lstsq(columns, pv)
    return np.sum((pv - columns @ weights) ** 2), weights


def fit_gain(response, candidate, structure, problem):
    known = problem.weight > 0
    decay = startup(len(response), candidate, structure)
    if squares(problem.basis[known], decay[known])[0] <= 1e-9:
        decay = np.zeros(len(response))  # over before the first known sample, or a part of level and drift
    columns = np.column_stack([response, decay, problem.basis])[known]
    error, weights = squares(columns, problem.pv[known])
    if weights[0] * problem.gain_sign >= 0:
        return error, weights[0], weights[1]
    error, weights = squares(columns[:, 1:], problem.pv[known])
    return error, 0.0, weights[0]


def free_run_error(candidate, structure, problem):
    response = process_response(valve_position(candidate, problem.op), candidate, structure)
    return fit_gain(response, candidate, structure, problem)[0]


def backward_sums(pv, pole):
    n = len(pv)
    filtered = [sum((1 - pole) * pole ** (k - t - 1) * pv[k] for k in range(t + 1, n)) for t in range(n)]
    return np.array([sum(filtered[t:]) for t in range(n)])


def scan_scores(op, pv, gain_sign, stem, s_values, j_ratios, starts, taus, delays):
    """Return the best explained share of each (S, J, start) and where in the bank it was reached."""
    n = len(op)
    scores = np.zeros((len(s_values), len(j_ratios), len(starts)))
    places = np.zeros(scores.shape, int)
    line = np.column_stack([np.ones(n), np.arange(n)])
    total = squares(line, pv)[0]
    for i, s in enumerate(s_values):
        for j, j_ratio in enumerate(j_ratios):
            f_s, f_d = bands(s, j_ratio)
            slip_before, met = None, []
            for r, start in enumerate(starts):
                x0 = op[0] - start * f_s
                position = valve(stem, op, f_s, f_d, x0)
                moves = np.flatnonzero(np.diff(position, prepend=x0))
                if len(moves) == 0:
                    continue
                slip = moves[0], np.sign(position[moves[0]] - x0)
                if slip == slip_before:
                    continue  # the start before this one told the same story
                slip_before = slip
                if np.any(np.abs(position[n // 6] - np.array(met)) <= stem[0] * stem[1] * np.ptp(op)):
                    continue
                met.append(position[n // 6])
                if len(moves) < 3:
                    continue
                for place, (tau, delay) in enumerate((tau, delay) for tau in taus for delay in delays):
                    share = explained(position - x0, pv, line, tau, delay, gain_sign) / total
                    if share > scores[i, j, r]:
                        scores[i, j, r], places[i, j, r] = share, place
    return scores, places


def explained(position, pv, line, tau, delay, gain_sign):
    n = len(pv)
    answer = np.concatenate([np.zeros(delay + 1), first_order(position, tau)])[:n]
    nuisance = np.column_stack([line, np.exp(-np.arange(n) / tau)])
    if squares(nuisance, answer)[0] <= 1e-6 * np.sum(answer**2):
        return 0.0  # the response itself is a nuisance
    error, weights = squares(np.column_stack([answer, nuisance]), pv)
    return squares(line, pv)[0] - error if weights[0] * gain_sign >= 0 else 0.0
