"""The flow chart of Choudhury et al. (2005) as published; not for use: see test_stiction_law_twins.py."""


def choudhury2005_flow_chart(op, s, j, x0):
    """Return the positions, without the limits of the stroke; OP must be known throughout."""
    position = []
    y, former, former_v = x0, op[0], 0
    turned_at, stopped = op[0], True
    for u in op:
        v = (u > former) - (u < former)
        if v != former_v:
            turned_at = former
            stopped = stopped or v == 0
        elif abs(u - turned_at) > (j if stopped else s):
            y, stopped = u - v * (s - j) / 2, False
        former, former_v = u, v
        position.append(y)
    return position
