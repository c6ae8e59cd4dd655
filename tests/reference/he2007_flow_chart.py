"""The valve of He et al. (2007) as its flow chart is printed: residual force u_r and cumulated force cum."""

import math


def he2007_flow_chart(op, f_s, f_d, x0):
    """Return the positions; OP while NaN changes nothing, so ``u`` is the last OP that was known."""
    position = []
    x, u, u_r = x0, x0, 0.0
    for new in op:
        if not math.isnan(new):
            cum = u_r + (new - u)
            if abs(cum) > f_s:
                x += math.copysign(abs(cum) - f_d, cum)
                u_r = math.copysign(f_d, cum)
            else:
                u_r = cum
            u = new
        position.append(x)
    return position
