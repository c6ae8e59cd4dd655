"""The force-consistent form of Choudhury's valve, branch by branch as in reference methods.md 1.4."""

import math


def sign(number):
    return math.copysign(1, number) if number else 0


def choudhury2005_branches(op, s, j, x0):
    """Return the positions; at the start and after a gap OP is reckoned to come from where the stem is."""
    position = []
    y, former, former_v = x0, x0, 0
    rests, stopped_at = True, x0 + (s - j) / 2
    for u in op:
        if math.isnan(u):
            if not rests:
                stopped_at = former
            rests, former, former_v = True, y, 0
            position.append(y)
            continue
        v = sign(u - former)
        if v == former_v and not rests:
            moves = True
        elif v == former_v:
            onward = sign(u - stopped_at) * sign(stopped_at - y) == 1
            moves = abs(u - stopped_at) > j if onward else abs(u - y) > (s + j) / 2
        else:
            if not rests:
                stopped_at = former
            moves = v != 0 and abs(u - y) > (s + j) / 2
        if moves:
            y = u - v * (s - j) / 2
        rests, former, former_v = not moves, u, v
        position.append(y)
    return position
