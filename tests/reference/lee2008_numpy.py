"""Lee, Ren and Huang's map in NumPy, as fast as that goes: what the compiled one is timed against.

Records without gaps, first and second order. ``map_by_candidate`` takes one valve after the other, as the
paper's workflow reads; ``map_at_once`` takes all together and loops over time (reference ``methods.md`` 4.1).
"""

import numpy as np
from scipy.signal import lfilter

from agent.analysis.quantify.processes.output_error import SECOND_ORDER


def map_by_candidate(op, pv, bands, delays, structure):
    """Mean squared free-run errors, PV units squared, shape (k, d); infinite where not plausible."""
    order = 2 if structure == SECOND_ORDER else 1
    moves = (op - op[0]).tolist()
    errors = np.full((len(bands), len(delays)), np.inf)
    for i, (f_s, f_d) in enumerate(bands.tolist()):
        mv = valve_position(moves, f_s, f_d)
        for j, delay in enumerate(delays.tolist()):
            errors[i, j] = error_of(mv, pv, delay, order)
    return errors


def valve_position(op, f_s, f_d):
    """He's valve about its mean; in plain Python, which is faster than NumPy one number at a time."""
    position, x = [], 0.0
    for u in op:
        force = u - x
        if force > f_s:
            x = u - f_d
        elif force < -f_s:
            x = u + f_d
        position.append(x)
    mv = np.array(position)
    return mv - mv.mean()


def error_of(mv, pv, delay, order):
    n = len(pv)
    past = [pv[delay : n - 1], pv[delay - 1 : n - 2]][:order]
    inputs = [mv[1 : n - delay], mv[: n - delay - 1]][:order]
    target = pv[delay + 1 :]
    coefficients, _, rank, _ = np.linalg.lstsq(np.stack([*past, *inputs], axis=1), target)
    a, b = coefficients[:order], coefficients[order:]
    if rank < 2 * order or b.sum() * b[0] < 0 or not stable(*a):
        return np.inf
    forced = sum(gain * x for gain, x in zip(b, inputs, strict=True))
    start = [a[0] * pv[delay]] if order == 1 else [a[0] * pv[delay] + a[1] * pv[delay - 1], a[1] * pv[delay]]
    model, _ = lfilter([1.0], [1.0, *-a], forced, zi=start)
    return np.mean((target - model) ** 2)


def stable(a1, a2=0.0):
    discriminant = a1 * a1 + 4 * a2
    return a1 > 0 and discriminant >= 0 and (a1 + np.sqrt(discriminant)) / 2 < 1


def map_at_once(op, pv, bands, delays, structure):
    """As ``map_by_candidate``."""
    order = 2 if structure == SECOND_ORDER else 1
    mv = valve_positions(op, bands)
    errors = [errors_of(mv, pv, int(delay), order) for delay in delays]
    return np.stack(errors, axis=1)


def valve_positions(op, bands):
    """He's valves about their means, shape (n, k)."""
    f_s, f_d = bands.T
    mv = np.empty((len(op), len(bands)))
    x = np.zeros(len(bands))
    for t, u in enumerate(op - op[0]):
        force = u - x
        x = np.where(np.abs(force) > f_s, u - np.copysign(f_d, force), x)
        mv[t] = x
    return mv - mv.mean(axis=0)


def errors_of(mv, pv, delay, order):
    """Errors of all valves at one delay, shape (k,)."""
    n, candidates = mv.shape
    past = np.stack([pv[delay : n - 1], pv[delay - 1 : n - 2]][:order])
    inputs = [mv[1 : n - delay], mv[: n - delay - 1]][:order]
    target = pv[delay + 1 :]
    normal = np.empty((candidates, 2 * order, 2 * order))
    right = np.empty((candidates, 2 * order))
    normal[:, :order, :order] = past @ past.T
    right[:, :order] = past @ target
    for i, x in enumerate(inputs, start=order):
        normal[:, :order, i] = normal[:, i, :order] = (past @ x).T
        right[:, i] = target @ x
        for j, z in enumerate(inputs, start=order):
            normal[:, i, j] = np.einsum("tk,tk->k", x, z)
    moves = np.ptp(mv, axis=0) > 0
    coefficients = np.full((candidates, 2 * order), np.nan)
    coefficients[moves] = np.linalg.solve(normal[moves], right[moves][..., None])[..., 0]
    a, b = coefficients[:, :order].T, coefficients[:, order:].T
    model, before = np.full(candidates, pv[delay]), np.full(candidates, pv[delay - 1])
    total = np.zeros(candidates)
    with np.errstate(over="ignore", invalid="ignore"):  # unstable ones, which are thrown away below
        for t, measured in enumerate(target):
            new = a[0] * model + b[0] * inputs[0][t]
            if order == 2:
                new += a[1] * before + b[1] * inputs[1][t]
            model, before = new, model
            total += (measured - new) ** 2
    a2 = a[1] if order == 2 else 0.0
    gain = b.sum(axis=0)
    with np.errstate(invalid="ignore"):
        pole = (a[0] + np.sqrt(a[0] ** 2 + 4 * a2)) / 2
        good = (gain * b[0] >= 0) & (a[0] > 0) & (pole < 1)
    return np.where(good, total / len(target), np.inf)
