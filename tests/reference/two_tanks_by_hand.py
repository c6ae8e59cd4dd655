"""Two tanks in steps so short that the scheme does not matter; what exceeds a rim runs over it."""


def levels(command, ts, tanks, steps=400):
    pv, dt = [], ts / steps
    upper = min(tanks.start_1, tanks.limit_1)
    lower = min(tanks.start_2, tanks.limit_2) - tanks.zero
    for u in command:
        pv.append(tanks.zero + lower)
        for _ in range(steps):
            between = tanks.flow_1 * upper**tanks.exponent_1
            out = tanks.flow_2 * lower**tanks.exponent_2
            upper += dt * (max(tanks.pump * u, 0.0) - between)
            lower += dt * (between - out)
            over = max(upper - tanks.limit_1, 0.0)
            lower += tanks.share * over
            upper, lower = max(upper - over, 0.0), max(lower, 0.0)
            lower = min(lower, tanks.limit_2 - tanks.zero)
    return pv
