"""The valve of He and Wang (2010, 2014) as reference methods.md 1.7 writes it."""

import math


def he_wang2014_branches(op, f_s, f_d, x0, K):
    """Return the positions; while OP is missing they hold."""
    position = [x0]
    for u in op:
        e = u - position[-1]
        slips = not math.isnan(u) and abs(e) > f_s
        position.append(position[-1] + (K * (e - math.copysign(f_d, e)) if slips else 0.0))
    return position[1:]
