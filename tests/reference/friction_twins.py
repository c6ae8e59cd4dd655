"""Slow, obvious twins of the kernels of simulators/friction.py and simulators/process.py.

The friction laws are written down as their papers have them and integrated by explicit Euler in steps so
short that the scheme does not matter; the kernels are implicit and take long steps.
"""

import math


def stribeck(speed, stem):
    f_s, f_d = (stem.f_s_closing, stem.f_d_closing) if speed < 0 else (stem.f_s, stem.f_d)
    return f_d + (f_s - f_d) * math.exp(-((speed / stem.stribeck) ** 2))


def karnopp(x, v, p, seconds, dt, stem):
    """Position and speed after ``seconds`` of a constant actuator force ``p``, all in OP units and s."""
    for _ in range(round(seconds / dt)):
        force = p - x
        if abs(v) < stem.still:  # at rest: friction holds as much as it must, up to f_s
            v = 0.0
            friction = max(-stem.f_s_closing, min(stem.f_s, force))
        else:
            friction = math.copysign(stribeck(v, stem), v)
        before = v
        v += dt * (force - friction - stem.damping * v) / stem.inertia
        if before * v < 0:
            v = 0.0  # passing through rest, it may stick
        x += dt * v
    return x, v


def lugre(x, v, z, p, seconds, dt, stem):
    """Position, speed and bristle deflection after ``seconds`` of a constant actuator force ``p``."""
    for _ in range(round(seconds / dt)):
        bristle_speed = v - abs(v) * stem.bristle_stiffness * z / stribeck(v, stem)
        friction = stem.bristle_stiffness * z + stem.bristle_damping * bristle_speed
        v += dt * (p - x - friction - stem.damping * v) / stem.inertia
        z += dt * bristle_speed
        x += dt * v
    return x, v, z


def lag(inputs, level, keep):
    """First-order lag as the sum over all past inputs."""
    return [
        keep ** (n + 1) * level + (1 - keep) * sum(keep ** (n - i) * inputs[i] for i in range(n + 1))
        for n in range(len(inputs))
    ]
