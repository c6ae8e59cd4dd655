"""Lee, Ren and Huang's objective written for the eye: one valve, one delay, one structure at a time."""

import numpy as np

from agent.analysis.quantify.processes.output_error import FEWEST_ROWS, INTEGRATOR, SECOND_ORDER
from agent.analysis.quantify.valves.valve_law import CHOUDHURY, HE, KANO
from tests.reference.he2007_flow_chart import he2007_flow_chart
from tests.reference.two_state_branches import two_state_branches

LAWS = {HE: he2007_flow_chart, CHOUDHURY: two_state_branches, KANO: two_state_branches}


def output_error(op, pv, f_s, f_d, delay, structure, gain_sign, law):
    mv = valve_position(op, f_s, f_d, law)
    if structure == INTEGRATOR:
        coefficients = integrator(mv, pv, delay)
    else:
        coefficients = arx(mv, pv, delay, order=2 if structure == SECOND_ORDER else 1)
    if coefficients is None or not plausible(coefficients, structure, gain_sign):
        return np.inf
    difference = pv - free_run(mv, pv, delay, *coefficients)
    rows = np.isfinite(difference)
    return np.mean(difference[rows] ** 2) if rows.sum() >= FEWEST_ROWS else np.inf


def valve_position(op, f_s, f_d, law):
    known = np.isfinite(op)
    mv = np.where(known, LAWS[law](op, f_s, f_d, op[known][0]), np.nan)
    return mv - np.mean(mv[known])


def integrator(mv, pv, delay):
    slope, x = np.diff(pv)[delay:], mv[1:-delay]
    known = np.isfinite(slope) & np.isfinite(x)
    if not known.any() or np.ptp(x[known]) == 0:
        return None
    b1, bias = np.polyfit(x[known], slope[known], 1)
    return 1.0, 0.0, b1, 0.0, bias


def shifted(values, lag):
    return np.concatenate([np.full(lag, np.nan), values[: len(values) - lag]])


def arx(mv, pv, delay, order):
    columns = [shifted(pv, k) for k in range(1, order + 1)] + [shifted(mv, delay + k) for k in range(order)]
    regressors = np.stack(columns, axis=1)
    known = np.isfinite(regressors).all(axis=1) & np.isfinite(pv) & (np.arange(len(pv)) > delay)
    if np.linalg.matrix_rank(regressors[known]) < 2 * order:
        return None
    c, *_ = np.linalg.lstsq(regressors[known], pv[known])
    return (c[0], 0.0, c[1], 0.0, 0.0) if order == 1 else (*c, 0.0)


def plausible(coefficients, structure, gain_sign):
    a1, a2, b1, b2, _ = coefficients
    if gain_sign * (b1 + b2) < 0 or b1 * (b1 + b2) < 0:
        return False
    if structure == INTEGRATOR:
        return True
    poles = np.roots([1.0, -a1, -a2])
    if np.iscomplex(poles).any():
        return False
    slowest = max(poles, key=abs)
    return 0 < slowest.real < 1


def free_run(mv, pv, delay, a1, a2, b1, b2, bias):
    model = np.full(len(pv), np.nan)
    past = list(pv)  # the measured PV is overwritten by the model as soon as there is one
    for t in range(max(2, delay + 1), len(pv)):
        y = a1 * past[t - 1] + a2 * past[t - 2] + b1 * mv[t - delay] + b2 * mv[t - delay - 1] + bias
        model[t] = y
        if np.isfinite(y):
            past[t] = y
    return model
