"""The valve of Kano et al. (2004) as its flow chart is printed: the OP of the stop u_s, the direction d."""

import math


def kano2004_flow_chart(op, up, down, x0):
    """Return the positions; ``up`` and ``down`` are (S, J) of either direction.

    S of a reversal is what keeps the force: kinetic friction of the stroke that ended plus static friction of
    the new one. At the start and after a gap OP is reckoned to come from where the stem stands.
    """
    f_s = {1: sum(up) / 2, -1: sum(down) / 2}
    f_d = {1: (up[0] - up[1]) / 2, -1: (down[0] - down[1]) / 2}
    position = []
    y, d, rests = x0, 1, True
    stopped_at = x0 + f_d[1]
    former, former_du = x0, 0.0
    for u in op:
        if math.isnan(u):
            if not rests:
                stopped_at, rests = former, True
            former, former_du = y, 0.0
            position.append(y)
            continue
        du = u - former
        if du * former_du <= 0 and not rests:
            stopped_at, rests = former, True
        if rests and -d * (u - stopped_at) > f_d[d] + f_s[-d]:
            d, rests = -d, False
        elif rests and d * (u - stopped_at) > f_s[d] - f_d[d]:
            rests = False
        if not rests:
            y = u - d * f_d[d]
        former, former_du = u, du
        position.append(y)
    return position
