"""The two-state valve as its branches are written in reference methods.md 1.5."""

import math


def two_state_branches(op, f_s, f_d, x0):
    """Return the positions; a missing OP brings the stem to rest where it is."""
    position = []
    x, moving, direction = x0, False, 0
    former = op[0]
    for u in op:
        if math.isnan(u):
            moving = False
        else:
            du = 0.0 if math.isnan(former) else u - former
            e = u - x
            if moving and du * direction > 0:
                x = u - direction * f_d
            else:
                moving = False
                if abs(e) > f_s:
                    direction = math.copysign(1, e)
                    x = u - direction * f_d
                    moving = True
        former = u
        position.append(x)
    return position
