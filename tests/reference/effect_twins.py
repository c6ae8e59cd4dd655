"""Kernels of the effects with their branches written out, and step responses by partial fractions."""

import math


def backlash_branches(command, width, x0):
    """Return the plug's positions; the stem has slack of half the width on either side."""
    positions, x = [], x0
    for u in command:
        if u - x > width / 2:
            x = u - width / 2
        elif x - u > width / 2:
            x = u + width / 2
        positions.append(x)
    return positions


def slewed_branches(command, step):
    """Return what follows a command by at most ``step`` a sample."""
    positions = []
    for u in command:
        x = positions[-1] if positions else u
        if abs(u - x) <= step:
            positions.append(u)
        else:
            positions.append(x + step if u > x else x - step)
    return positions


def held_in_small_steps(inputs, tau, curvature, steps=2000):
    """Return what a vessel holds whose losses grow as an exponential, by small steps of Euler."""
    held, x = [], 0.0
    for u in inputs:
        held.append(x)
        for _ in range(steps):
            x += (u - (math.exp(curvature * x) - 1) / curvature) / (tau * steps)
    return held


def process_step_response(lags, lead, integrates):
    """Return the step response of (1 - lead s) / ((1 + lag s) ...) or / (s (1 + lag s)), lags differ."""

    def response(t):
        terms = []
        for i, own in enumerate(lags):
            weight = own ** (len(lags) - 1)
            for j, other in enumerate(lags):
                if j != i:
                    weight /= own - other
            terms.append((own, weight))
        y = 1 - sum(weight * math.exp(-t / own) for own, weight in terms)
        speed = sum(weight / own * math.exp(-t / own) for own, weight in terms)
        if integrates:
            ramp = t - sum(weight * own * (1 - math.exp(-t / own)) for own, weight in terms)
            return ramp - lead * y
        return y - lead * speed

    return response
