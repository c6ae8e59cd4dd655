"""The process behind a known path by dense least squares: columns by differences, one matrix, ``lstsq``."""

import numpy as np
from scipy.signal import lfilter

from agent.identify.objective import DELAY, INTEGRATOR, LOG_TAU, LOG_TAU2, process_response

SMALL = 1e-5


def columns(candidate, structure, problem, position):
    """Return response, its derivatives by log tau, log tau2 and delay (samples), and start-up, weighted."""
    response = _response(candidate, structure, problem, position)
    found = [response]
    for axis in (LOG_TAU, LOG_TAU2, DELAY):
        more, less = candidate.copy(), candidate.copy()
        more[axis] += SMALL
        less[axis] -= SMALL
        up, down = (_response(each, structure, problem, position) for each in (more, less))
        found.append((up - down) / (2 * SMALL))
    at = np.arange(len(problem.pv))
    start_up = np.zeros(len(at))
    if structure != INTEGRATOR:
        start_up = np.exp(-at * problem.block / np.exp(candidate[LOG_TAU]))
    found.append(start_up)
    return np.stack(found, axis=1) * problem.weight[:, None]


def error(candidate, structure, problem, position, gain_sign):
    """Return the least sum of squares of PV less response, start-up and nuisance; the gain has its sign."""
    all_columns = columns(candidate, structure, problem, position)
    used = [0] if structure == INTEGRATOR else [0, 4]
    left, solution = _left(np.hstack([all_columns[:, used], problem.basis]), problem.pv)
    if solution[0] * gain_sign >= 0:
        return left
    return _left(np.hstack([all_columns[:, used[1:]], problem.basis]), problem.pv)[0]


def step(candidate, structure, problem, position):
    """Return the error that all columns leave, and the step in log tau, log tau2 and delay."""
    matrix = np.hstack([columns(candidate, structure, problem, position), problem.basis])
    left, solution = _left(matrix, problem.pv)
    return left, solution[1:4] / solution[0]


def _response(candidate, structure, problem, position):
    response = process_response(position, candidate, structure, problem.block, problem.keep)
    return lfilter(np.concatenate(([1.0], -problem.whitening)), [1.0], response)


def _left(matrix, pv):
    solution = np.linalg.lstsq(matrix, pv, rcond=1e-12)[0]
    rest = pv - matrix @ solution
    return float(rest @ rest), solution
