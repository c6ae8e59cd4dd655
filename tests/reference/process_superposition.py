"""Processes as sums of their step responses, one step for every move of the valve."""

import math


def first_order(t, tau):
    return 1 - math.exp(-t / tau)


def second_order(t, tau, tau2):
    if tau == tau2:
        return 1 - (1 + t / tau) * math.exp(-t / tau)
    return 1 - (tau * math.exp(-t / tau) - tau2 * math.exp(-t / tau2)) / (tau - tau2)


def ramp(t):
    return t


STEP_RESPONSES = {"fopdt": first_order, "sopdt": second_order, "integrator": ramp}


def superposition(name, position, *lags, delay):
    """Return PV at the samples; a move at sample k is felt ``delay`` less the sample of the hold later."""
    return summed_steps(lambda t: STEP_RESPONSES[name](t, *lags), position, delay)


def summed_steps(step_response, position, delay):
    """Return the sum of a step response for each move."""
    response = []
    for t in range(len(position)):
        y = 0.0
        for k in range(1, t + 1):
            elapsed = t - (k + delay - 1)
            if elapsed > 0:
                y += (position[k] - position[k - 1]) * step_response(elapsed)
        response.append(y)
    return response


def interpolated_lag(position, tau, delay):
    """Return a first-order lag whose fraction of a sample is interpolated between its outputs: not exact."""
    keep = math.exp(-1 / tau)
    whole = int(delay)
    part = delay - whole
    lagged = [0.0]
    for held in position[:-1]:
        lagged.append(keep * lagged[-1] + (1 - keep) * (held - position[0]))
    rested = [0.0] * whole + lagged  # rested[i] is the output at sample i - whole
    return [(1 - part) * rested[t + 1] + part * rested[t] for t in range(len(position))]
