"""The damped stem as an engineer would tell it: does it move, how far, does it rest then?"""

import math


def damped_stem_branches(op, f_s, f_d, x0, lag, rest):
    """Return the positions; a missing OP brings the stem to rest where it is."""
    position = []
    x, direction = x0, 0
    for u in op:
        if math.isnan(u):
            direction = 0
        else:
            goes_on = direction != 0 and direction * (u - direction * f_d - x) > 0
            if not goes_on:
                direction = int(math.copysign(1, u - x)) if abs(u - x) > f_s else 0
            if direction != 0:
                balance = u - direction * f_d
                way = abs(balance - x)
                x = balance - lag * (balance - x)
                if way <= rest:
                    direction = 0
        position.append(x)
    return position
