"""Extended least squares beside a walking bias, by the covariance matrix of the whole record."""

import numpy as np

from agent.analysis.quantify.processes.armax import HALVINGS, SWEEPS
from agent.analysis.quantify.processes.output_error import FIRST_ORDER, INTEGRATOR


def shifted(values, lag):
    return np.concatenate([np.full(lag, np.nan), values[: len(values) - lag]])


def regression(mv, pv, delay, structure):
    """Regressors (n, k), what they explain (n,), and where all is known (n,)."""
    if structure == INTEGRATOR:
        columns, explained = [shifted(mv, delay)], pv - shifted(pv, 1)
    elif structure == FIRST_ORDER:
        columns, explained = [shifted(pv, 1), shifted(mv, delay)], pv
    else:
        columns = [shifted(pv, 1), shifted(pv, 2), shifted(mv, delay), shifted(mv, delay + 1)]
        explained = pv
    regressors = np.stack(columns, axis=1)
    known = np.isfinite(regressors).all(axis=1) & np.isfinite(explained) & (np.arange(len(pv)) > delay)
    return regressors, explained, known


def covariance(times, walk):
    """Of e plus a walk that is zero at the first of the times, over the variance of e."""
    since = times - times[0]
    return np.eye(len(times)) + walk**2 * np.minimum.outer(since, since)


def level_and_walk(rest, times, walk, at):
    """Best linear estimate of the bias at the time ``at`` from ``rest`` at ``times``, the walk's first."""
    inverse = np.linalg.inv(covariance(times, walk))
    ones = np.ones(len(times))
    level = ones @ inverse @ rest / (ones @ inverse @ ones)
    along = walk**2 * np.minimum(np.maximum(at - times[0], 0), times - times[0])
    return level + along @ inverse @ (rest - level)


def armax(mv, pv, delay, structure, noise_order, walk):
    """Weights, eta, variance of e and AIC."""
    regressors, explained, known = regression(mv, pv, delay, structure)
    times = np.flatnonzero(known)
    linear = regressors.shape[1]
    noise = np.zeros(len(pv))
    best = None
    for sweep in range(SWEEPS if noise_order else 1):
        past = [shifted(noise, lag) for lag in range(1, noise_order + 1)] if sweep else []
        columns = np.column_stack([regressors[times], *(each[times] for each in past), np.ones(len(times))])
        inverse = np.linalg.inv(covariance(times, walk))
        solved = np.linalg.solve(columns.T @ inverse @ columns, columns.T @ inverse @ explained[times])
        aim = np.zeros(linear + noise_order)
        aim[: len(solved) - 1] = solved[:-1]
        steps = [aim] if best is None else [best[1] + (aim - best[1]) / 2**k for k in range(HALVINGS)]
        for weights in steps:
            if (np.abs(np.roots([1.0, *weights[linear:]])) >= 1).any():
                continue
            noise, rest = innovations(weights, regressors, explained, times, noise_order, walk)
            criterion, variance = minus_two_log_likelihood(rest[times], times, walk)
            if best is None or criterion < best[0]:
                break
        else:
            break
        eta = [level_and_walk(rest[times], times, walk, t) for t in range(len(pv))]
        best = criterion, weights, np.array(eta), variance
    criterion, weights, eta, variance = best
    return weights, eta, variance, criterion + 2 * (len(weights) + 2)


def innovations(weights, regressors, explained, times, noise_order, walk):
    """The rest of each sample after bias and past noise; and with bias."""
    linear = regressors.shape[1]
    noise = np.zeros(len(explained))
    rest = np.full(len(explained), np.nan)
    for i, t in enumerate(times):
        past = sum(weights[linear + k] * noise[t - k - 1] for k in range(noise_order))
        rest[t] = explained[t] - regressors[t] @ weights[:linear] - past
        until = times[: i + 1]
        noise[t] = rest[t] - level_and_walk(rest[until], until, walk, t)
    return noise, rest


def minus_two_log_likelihood(rest, times, walk):
    """Of all but the level, constants left out, at the most likely variance."""
    inverse = np.linalg.inv(covariance(times, walk))
    ones = np.ones(len(times))
    about = rest - ones @ inverse @ rest / (ones @ inverse @ ones)
    count = len(times) - 1
    variance = about @ inverse @ about / count
    _, determinant = np.linalg.slogdet(covariance(times, walk))
    return count * (np.log(variance) + 1) + determinant + np.log(ones @ inverse @ ones), variance
