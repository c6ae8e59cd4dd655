"""The kernels of ``free_run`` written for the eye: one regressor a column, NumPy's least squares."""

import numpy as np
from scipy.signal import lfilter

from agent.identify.objective import DELAY, INTEGRATOR, LOG_TAU, LOG_TAU2, SOPDT
from agent.physics.valves.damped_stem import damped_stem


def high_pass(signal, keep):
    """From rest at the first value."""
    return lfilter([keep, -keep], [1, -keep], signal - signal[0])


def first_order(values, tau):
    """Unit gain, at rest at zero before the first sample; it answers in the same sample."""
    pole = np.exp(-1 / tau)
    return lfilter([1 - pole], [1, -pole], values)


def process_response(position, candidate, structure, block, keep):
    """Average, filter, pass through the process, then shift; the record starts at rest."""
    blocks = position[: len(position) // block * block].reshape(-1, block).mean(axis=1)
    start = blocks[0] if block > 1 else position[0]
    passed = high_pass(np.concatenate([[start], blocks]), keep)[1:]
    if structure == INTEGRATOR:
        answer = block * np.cumsum(passed)
    else:
        tau, tau2 = np.exp(candidate[LOG_TAU]), np.exp(min(candidate[LOG_TAU2], candidate[LOG_TAU]))
        answer = first_order(passed, tau / block)
        if structure == SOPDT:
            answer = first_order(answer, tau2 / block)
    lag = (candidate[DELAY] - 1) / block + (block + 1) / (2 * block)
    whole, t = int(lag), np.arange(len(answer))
    shifted = np.interp(t - lag, t, answer, left=0.0)
    between = (t >= whole) & (t < lag)  # the first answer comes in with the part of it that is due
    shifted[between] = (1 - (lag - whole)) * answer[0]
    return shifted


def startup(m, candidate, structure, block):
    """The process' own state before the record dies away; an integrator has none, level is its state."""
    if structure == INTEGRATOR:
        return np.zeros(m)
    decay = np.exp(-np.arange(m) * block / np.exp(candidate[LOG_TAU]))
    return np.where(decay < 1e-9, 0.0, decay)


def squares(columns, pv):
    """Return the least sum of squares of pv minus a combination of the columns, and the combination."""
    weights, *_ = np.linalg.lstsq(columns, pv)
    return np.sum((pv - columns @ weights) ** 2), weights


def fit_gain(response, candidate, structure, problem):
    known = problem.weight > 0
    decay = startup(len(response), candidate, structure, problem.block)[known]
    nuisance = problem.basis[known]
    if squares(nuisance, decay)[0] > 1e-4 * np.sum(decay**2):
        nuisance = np.column_stack([decay, nuisance])  # else over before the first block that counts
    error, weights = squares(np.column_stack([response[known], nuisance]), problem.pv[known])
    if weights[0] * problem.gain_sign >= 0:
        return error, weights[0]
    return squares(nuisance, problem.pv[known])[0], 0.0


def backward_sums(signal, pole, second, gain):
    """The impulse response against what follows, summed from each block on."""
    m = len(signal)
    impulse = lfilter([gain], np.convolve([1, -pole], [1, -second]), np.eye(1, m)[0])
    filtered = [sum(impulse[k - t] * signal[k] for k in range(t, m)) for t in range(m)]
    return np.cumsum(filtered[::-1])[::-1]


def bank_response(means, delay, place, bank):
    """One process of the bank, ``delay`` whole blocks late."""
    response = lfilter(
        [bank.gains[place]],
        np.convolve([1, -bank.poles[place]], [1, -bank.second[place]]),
        high_pass(means, bank.keep),
    )
    return np.concatenate([np.zeros(delay), response])[: len(means)]


def bank_share(response, pv, bank):
    """Return the share of PV explained by a response beside level and filter memory, and its gain.

    A response that is all but level and memory has gain NaN: the bank passes over it.
    """
    at = np.arange(bank.burn, len(pv))
    nuisance = np.column_stack([np.ones(len(at)), bank.keep**at])
    error, weights = squares(np.column_stack([response[at], nuisance]), pv[at])
    left = squares(nuisance, response[at])[0]
    gain = weights[0] if left > 1e-3 * np.sum(response[at] ** 2) else np.nan
    return 1 - error / squares(nuisance, pv[at])[0], gain


def moves(position, block):
    """Return the block means of the position less its first value, and how often they change."""
    means = position[: len(position) // block * block].reshape(-1, block).mean(axis=1) - position[0]
    return means, np.count_nonzero(np.diff(means, prepend=0.0))


def first_slip(op, s, up):
    """Whichever end of a band as wide as S is passed first."""
    above, below = np.append(op, np.inf) > up, np.append(op, -np.inf) < up - s
    return (up, 1.0) if np.argmax(above) <= np.argmax(below) else (up - s, -1.0)


def levels(op, s, step):
    """Upper levels of the first slip to try, at equal distances within what ``op`` reaches."""
    low, high = op.min(), op.max()
    if s > high - low:
        return [high - 0.5 * step]
    edges = np.linspace(low + s, high, max(1, int((high - low - s) / step)) + 1)
    return (edges[1:] + edges[:-1]) / 2


def best_of_cell(bank, pv, valve, stem, step, delays):
    """Return the best share of one (S, J), the place of its process and the level of its first slip.

    ``valve``: f_S and f_D. A valve that is within a thousandth of f_S of a former one in the early part is
    passed over.
    """
    early = bank.early
    ends = []
    best = (0.0, 0, 0.0)
    for up in levels(bank.op[:early], sum(valve), step):
        level, direction = first_slip(bank.op, sum(valve), up)
        position = damped_stem(bank.op, *valve, level - direction * valve[0], *stem)
        end = position[early - 1]
        if any(abs(end - other) <= 1e-3 * valve[0] for other in ends):
            continue
        ends.append(end)
        means, moved = moves(position, bank.block)
        if moved < 3:
            continue
        for place in np.flatnonzero(bank.gains):
            for q, delay in enumerate(delays):
                share, gain = bank_share(bank_response(means, delay, place, bank), pv, bank)
                if gain * bank.gain_sign >= 0 and share > best[0]:
                    best = (share, place * len(delays) + q, up)
    return best
