"""The damped stem in many small steps: air reaches the actuator, the stem creeps, breaks away or rests."""

import math


def damped_stem_in_small_steps(op, f_s, f_d, x0, damping, supply, rest, give=0.0, steps=400):
    """Return the mean positions over each sample."""
    return by_direction_in_small_steps(op, f_s, f_s, f_d, x0, damping, supply, rest, give, steps)


def by_direction_in_small_steps(op, f_s_up, f_s_down, f_d, x0, damping, supply, rest, give=0.0, steps=400):
    """Return the mean positions of a stem with static friction of its own in either direction.

    A missing OP stops the stem; the next one finds the actuator settled at it.
    """
    jump = {1: f_s_up - f_d, -1: f_s_down - f_d}
    stop = {each: min(rest * max(jump.values()), jump[each]) for each in jump}
    dt = 1 / steps
    keeps = math.exp(-dt / supply)
    position = []
    x, direction, force = x0, 0, math.nan
    for u in op:
        if math.isnan(u):
            direction, force = 0, math.nan
        elif math.isnan(force):
            force = u
        passed = []
        for _ in range(0 if math.isnan(u) else steps):
            before = x
            if direction == 0 and force - x > f_s_up - loosened(u - force, jump[1], give, stop[1]):
                direction = 1
            if direction == 0 and x - force > f_s_down - loosened(force - u, jump[-1], give, stop[-1]):
                direction = -1
            force = u + (force - u) * keeps
            way = direction * (force - x) - f_d
            if direction != 0 and way > stop[direction]:
                x += direction * way * (1 - math.exp(-dt / damping))
            else:
                direction = 0
            passed.append((before + x) / 2)
        position.append(sum(passed) / steps if passed else x)
    return position


def loosened(step_left, jump, give, stop):
    """By how much friction that gives falls while the force rises towards the rest of a step of OP."""
    return min(3 * (jump * (give * max(step_left, 0)) ** 2) ** (1 / 3), jump - stop)
