"""How friction holds a valve stem: steps of time under Karnopp's law and under LuGre.

All forces are divided by the rate of the spring, so that force and position share one unit, the unit of OP:

    m dv/dt = p - x - c v - F(v),        dx/dt = v

with the actuator force p and the position x (OP units), the inertia m (s2) and the viscous damping c (s).
Both steps are implicit in spring and damping and therefore stable at any step; their error is first order.

All kernels that call each other stand in this one file: numba's cache does not see a change in another.

Sources: Karnopp (1985), J. Dyn. Sys. Meas. Control 107:100; Canudas de Wit, Olsson, Astrom, Lischinsky
(1995), IEEE TAC 40:419; constants of valves in reference ``methods.md`` 1.8.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from agent.jit import kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]

Motion = tuple[float, float, float]
"""Position (OP units), speed (OP units per second) and mean deflection of the bristles (LuGre, OP units)."""


class StemParameters(NamedTuple):
    """A stem in its packing, in numbers a compiled loop takes."""

    f_s: float
    """Static friction, OP units."""
    f_d: float
    """Kinetic friction, OP units."""
    f_s_closing: float
    """Static friction against falling positions, where it differs, OP units."""
    f_d_closing: float
    """Kinetic friction of falling positions."""
    inertia: float
    """Moving mass over spring rate, s2."""
    damping: float
    """Viscous damping over spring rate, s."""
    stribeck: float
    """Speed over which friction falls from static to kinetic, OP units per second, > 0."""
    still: float
    """Karnopp's DV: below this speed a stem sticks if static friction can hold it, OP units per second."""
    bristle_stiffness: float
    """LuGre's sigma_0 over spring rate, without unit."""
    bristle_damping: float
    """LuGre's sigma_1 over spring rate, s."""


class Actuator(NamedTuple):
    """The valve around the stem, in numbers a compiled loop takes."""

    stem: StemParameters
    lugre: bool
    """LuGre's law; otherwise Karnopp's."""
    tau_ip: float
    """Lag of I/P converter and actuator, s."""
    rate: float
    """Most by which its air changes the force in a second, OP units per second; infinite where it can."""
    low: float
    """Lower stop, OP units."""
    high: float
    """Upper stop, OP units."""


@kernel
def sliding_friction(speed: float, stem: StemParameters) -> float:
    """Friction of a stem that moves at ``speed`` OP units per second (Stribeck), OP units."""
    closing = math.copysign(1.0, speed) < 0.0  # so that a stem about to close may say so by -0.0
    f_s, f_d = (stem.f_s_closing, stem.f_d_closing) if closing else (stem.f_s, stem.f_d)
    return f_d + (f_s - f_d) * math.exp(-((speed / stem.stribeck) ** 2))


@kernel
def karnopp_step(motion: Motion, p: float, dt: float, stem: StemParameters) -> Motion:
    """Motion one step of ``dt`` s later under Karnopp's law, with the actuator force ``p`` in OP units."""
    x, v, z = motion
    force = p - x
    holds = -stem.f_s_closing <= force <= stem.f_s
    if v == 0.0 and holds:
        return x, 0.0, z
    direction = math.copysign(1.0, force if v == 0.0 else v)
    friction = direction * sliding_friction(direction * abs(v), stem)
    moved = (stem.inertia * v / dt + force - friction) / (stem.inertia / dt + stem.damping + dt)
    if moved * direction < 0.0 or (abs(moved) < stem.still and holds):
        return x, 0.0, z  # friction stops a stem, it never drives it back
    return x + dt * moved, moved, z


@kernel
def lugre_step(motion: Motion, p: float, dt: float, stem: StemParameters) -> Motion:
    """Motion one step of ``dt`` s later under LuGre, with the actuator force ``p`` in OP units.

    The bristles' equation is solved for the new speed, with the wear-off rate |v|/g(v) of the step before.
    Both frictions must be > 0.
    """
    x, v, z = motion
    wear = dt * abs(v) * stem.bristle_stiffness / sliding_friction(v, stem)
    kept = 1.0 / (1.0 + wear)  # the new deflection is (z + dt v) kept
    hold = stem.bristle_stiffness + stem.bristle_damping / dt
    drive = stem.inertia * v / dt + (p - x) - hold * kept * z + stem.bristle_damping * z / dt
    moved = drive / (stem.inertia / dt + stem.damping + dt + hold * kept * dt)
    return x + dt * moved, moved, (z + dt * moved) * kept


@kernel
def stroke(state: FloatArray, op: float, steps: int, dt: float, actuator: Actuator) -> FloatArray:
    """Stem positions over ``steps`` steps of ``dt`` s with OP held, OP units, shape (steps,).

    ``state`` is actuator force, position, speed and bristle deflection; it is left as the stroke ends.
    """
    positions = np.empty(steps)
    keep = math.exp(-dt / actuator.tau_ip) if actuator.tau_ip > 0.0 else 0.0
    p, motion = state[0], (state[1], state[2], state[3])
    for i in range(steps):
        wanted = op + (p - op) * keep
        p = min(max(wanted, p - actuator.rate * dt), p + actuator.rate * dt)
        if actuator.lugre:
            motion = lugre_step(motion, p, dt, actuator.stem)
        else:
            motion = karnopp_step(motion, p, dt, actuator.stem)
        x, _, z = motion
        if x < actuator.low or x > actuator.high:
            motion = (min(max(x, actuator.low), actuator.high), 0.0, z)
        positions[i] = motion[0]
    state[0] = p
    state[1], state[2], state[3] = motion
    return positions
