"""Sticking valve whose stem has a lag and may slide on: an overdamped stem in a packing.

A slip is not over at once: air reaches the actuator late, viscous damping slows the stem, and friction that
rises again at low speed (Stribeck) stops it a little short of its balance. Whether it is at rest when OP
moves on decides whether it must break away again: He's model (``he2007``) rests after every slip, Kano's and
the two-state model (``two_state``) slide on as long as OP goes on, a real stem is between. Derived from
Karnopp's law with negligible inertia, OP held between samples and passed to the actuator by a first-order
lag; where the packing gives like bristles (LuGre), it breaks away early while the force rises. Break-away and
rest within a sample are solved for, so that no finer steps are needed.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from agent.jit import kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from agent.units import FrictionBands

DAMPING = (0.03, 0.9)
"""Range of a stem's time constant in a search, samples."""
SUPPLY = (0.02, 0.5)
"""Range of that of the air to the actuator, samples."""
REST = (3e-4, 0.3)
"""Range of the force over f_D at which a stem stops, over f_S - f_D."""
GIVE = (0.01, 0.5)
"""Range of the deflection of bristles that bend; from 0.5 on a sudden step may move a stem at f_D."""
SQUARINGS = 5
PART = 2.0**-SQUARINGS
"""Resolution with which the time of rest is found, samples."""
AT_ONCE = 0.05
"""Damping and supply together, samples, below which a slip begins and ends within the sample."""
HALLEY = 4
"""Steps towards the time of an early break-away; they approach it from one side, and 99 of 100 end within
1e-8 of the step of OP (Newton's, without the cube root, within 1e-4)."""
MEMORY = 6
"""Samples after which an earlier OP no longer affects the force of the supply."""


class Motion(NamedTuple):
    """Values of a stem that every sample needs, computed once: an exponential costs as much as all else."""

    damping: float
    """Time constant of the stem, samples."""
    supply: float
    """Time constant of the air to the actuator, samples; never quite that of the stem."""
    rest: float
    """Force over f_D at which the stem stops, over f_S - f_D."""
    give: float
    """Of the bristles (``damped_stem``)."""
    damping_keeps: float
    """Share of a distance that remains after a sample."""
    supply_keeps: float
    """Share of a step of OP that remains after a sample."""
    feeds: float
    """Damping over supply less damping."""
    part_slows: float
    """Share of a distance that remains after ``PART`` of a sample."""
    part_fills: float
    """Share of a step of OP that remains after it."""
    at_once: bool
    """Whether a slip ends within the sample."""


@kernel
def damped_stem(
    op: NDArray[np.float64],
    f_s: float,
    f_d: float,
    x0: float,
    damping: float,
    supply: float,
    rest: float,
    give: float = 0.0,
) -> NDArray[np.float64]:
    """Return the mean valve position over each sample, OP units, shape (n,).

    The mean, held, moves a process as the moving stem does, except for the shape of the motion; the position
    at the end of a sample, held, would move it too soon, by a time that differs from slip to slip.

    Args:
        op: Controller output, OP units, shape (n,).
        f_s: Static friction band, OP units.
        f_d: Kinetic friction band, OP units, 0 <= f_d <= f_s.
        x0: Position of the resting stem before the first sample, OP units.
        damping: Time constant of the stem, samples, > 0.
        supply: Time constant of the air to the actuator, samples, > 0.
        rest: Force over f_D at which the stem stops, over f_S - f_D (the larger one, where it differs by
            direction), 0 to 1; 0 slides on until OP turns.
        give: Of the bristles: their deflection when they break over twice the way that a stem at Stribeck's
            speed goes in ``supply``; 0: they are stiff, and the stem breaks away at f_S.

    With ``damping`` and ``supply`` of a hundredth of a sample it is He's model; with ``rest`` 0 and a
    ``damping`` of some hundredths the two-state one. While OP is NaN the position holds.
    """
    return damped_stem_by_direction(op, f_s, f_s, f_d, x0, damping, supply, rest, give)


@kernel
def damped_stem_by_direction(
    op: NDArray[np.float64],
    f_s_up: float,
    f_s_down: float,
    f_d: float,
    x0: float,
    damping: float,
    supply: float,
    rest: float,
    give: float = 0.0,
) -> NDArray[np.float64]:
    """Return the mean positions of a stem that breaks away upward at ``f_s_up`` and downward at ``f_s_down``.

    All else is as in ``damped_stem``. That ``f_d`` is one number is no loss: kinetic friction that differs by
    direction is a shift of the position (docs/effects/asymmetric_stiction.md).
    """
    position = np.empty(op.size)
    state = stem_at(x0, op[0])
    stem = stem_motion(damping, supply, rest, give)
    strokes(op, 0, op.size, state, (f_s_up, f_s_down, f_d), stem, position, op.size)
    return position


@kernel
def stem_motion(damping: float, supply: float, rest: float, give: float = 0.0) -> Motion:
    """Return the values of a stem that ``strokes`` needs; ``damping`` and ``supply`` in samples."""
    if abs(supply - damping) < 1e-6 * damping:
        supply *= 1.0 + 1e-5
    return Motion(
        damping=damping,
        supply=supply,
        rest=rest,
        give=give,
        damping_keeps=math.exp(-1.0 / damping),
        supply_keeps=math.exp(-1.0 / supply),
        feeds=damping / (supply - damping),
        part_slows=math.exp(-PART / damping),
        part_fills=math.exp(-PART / supply),
        at_once=damping + supply < AT_ONCE,
    )


@kernel
def stem_at(x: float, force: float) -> NDArray[np.float64]:
    """Return a resting stem as ``strokes`` moves it on, OP units, (5,).

    Position, force of the actuator, direction of motion (0 at rest), and of the direction in which it last
    broke away f_S - f_D and how far above f_D the force is when it stops.
    """
    state = np.zeros(5)
    state[0] = x
    state[1] = force
    return state


@kernel
def left_at_break_away(step: float, over: float, lead: float, most: float, keeps: float) -> float:
    """Return the part of a step of OP that is still to come when the stem breaks away, OP units; 0: it holds.

    Bristles that are being bent creep, and creep the faster the nearer the force is to f_S. While the force
    rises at the rate R, no creep below Stribeck's speed v_s balances it once it is within 3 (J/f_S)^(1/3)
    (R / (2 stiffness v_s))^(2/3) f_S of f_S: there the stem breaks away (derived from LuGre, Canudas de Wit
    1995, to leading order). R is the remaining part y of the step over ``supply``; so it holds while
    over - y + min(lead y^(2/3), most) < 0.

    Args:
        step: Of OP beyond the force at the start of the sample, towards the break-away, OP units, > 0.
        over: OP beyond the balance with f_S, OP units.
        lead: 3 (J give^2)^(1/3), OP units to the power of 1/3, > 0.
        most: Largest reduction of friction: to the force at which the stem comes to rest, OP units.
        keeps: Share of the step that remains after the sample.
    """
    nearest = min(8.0 / 27.0 * lead**3, (most / lead) ** 1.5)  # where it is closest to break-away
    least = min(max(nearest, step * keeps), step)
    if over - least + min(lead * np.cbrt(least) ** 2, most) < 0.0:
        return 0.0
    # In the cube root z of y: (z - lead) z^2 = over, from above, by Halley's steps.
    z = np.cbrt(min(step, over + most))
    for _ in range(HALLEY):
        excess, slope, bend = (z - lead) * z * z - over, (3.0 * z - 2.0 * lead) * z, 6.0 * z - 2.0 * lead
        if excess <= 0.0:
            break
        z -= 2.0 * excess * slope / (2.0 * slope * slope - excess * bend)
    return float(max(z * z * z, least))


@kernel
def strokes(
    op: NDArray[np.float64],
    begin: int,
    end: int,
    state: NDArray[np.float64],
    bands: tuple[float, float, float],
    stem: Motion,
    position: NDArray[np.float64],
    until_rest_after: int,
) -> int:
    """Move a stem through the samples ``begin`` to ``end`` and return the sample at which it goes on.

    Args:
        op: Controller output, OP units, (n,).
        begin: First sample.
        end: Sample before which it ends.
        state: From ``stem_at``, or as the samples before left it; it is moved on, (5,).
        bands: Static friction upward and downward, kinetic friction, OP units.
        stem: From ``stem_motion``.
        position: Takes the mean positions over each sample, OP units, (n,).
        until_rest_after: Ends where the stem comes to rest in this sample or a later one; ``end`` or more:
            it goes on to the end.
    """
    f_s_up, f_s_down, f_d = bands
    damping, supply, rest, feeds = stem.damping, stem.supply, stem.rest, stem.feeds
    damping_keeps, supply_keeps, at_once = stem.damping_keeps, stem.supply_keeps, stem.at_once
    x, force, direction, jump, stop = state[0], state[1], state[2], state[3], state[4]
    # Where f_S differs by direction, what bristles loosen (as y^(2/3), ``early`` at most) goes by the larger
    # jump; so does the force at rest, damping at Stribeck's speed, that hardly depends on how far f_S is.
    larger = max(f_s_up, f_s_down) - f_d
    gives = stem.give > 0.0
    lead = 3.0 * np.cbrt(larger * stem.give**2) if gives else 0.0
    early = 4.0 / 27.0 * lead**3
    t = begin
    while t < end:
        comes_to_rest = False
        if direction == 0.0 and early - f_s_down <= force - x <= f_s_up - early:
            # The force lies between what it was and OP: while both are within f_S nothing can happen.
            while t < end and early - f_s_down <= op[t] - x <= f_s_up - early:
                position[t] = x
                t += 1
            if t == end:
                break
        if math.isnan(op[t]):
            direction = 0.0
            position[t] = x
            t += 1
            continue
        mean = x
        if direction == 0.0:
            force = settled_force(op, t, supply_keeps)
        before = force
        force = op[t] + (before - op[t]) * supply_keeps
        # At the start of motion: the force and the distance to go; then the shares of distance and step that
        # remain at the end of the sample.
        begins, way = before, 0.0
        free, fed, moves = damping_keeps, supply_keeps, 1.0
        part_slows, part_fills = stem.part_slows, stem.part_fills
        if direction == 0.0:
            toward = 1.0 if force > x else -1.0
            f_s = f_s_up if force > x else f_s_down
            step = toward * (op[t] - before)
            over = toward * (op[t] - x) - f_s
            left_then = over
            breaks = toward * (force - x) > f_s
            if gives and step > 0.0 and f_s > f_d:
                most = f_s - f_d - min(rest * larger, f_s - f_d)
                left_then = left_at_break_away(step, over, lead, most, supply_keeps)
                breaks = left_then > 0.0
            if breaks:
                direction = toward
                jump = f_s - f_d
                stop = min(rest * larger, jump)
                if at_once or step <= left_then:
                    way = direction * (before - x) - f_d
                else:
                    # It breaks away when the force, exponentially on its way to OP, has so much of it left.
                    begins, way = op[t] - direction * left_then, jump + (over - left_then)
                    fed = supply_keeps * step / left_then
                    moves = 1.0 - supply * math.log(step / left_then)
                    part_slows = math.exp(-moves / damping * PART)
                    part_fills = math.exp(-moves / supply * PART)
                    free = part_slows
                    for _ in range(SQUARINGS):
                        free *= free
        else:
            way = direction * (before - x) - f_d
            if way <= stop and direction * (force - x) - f_d <= stop:
                direction = 0.0
                comes_to_rest = True
        if direction != 0.0:
            # The way left obeys w' = -w / damping + the rise of the actuator's force.
            forced = direction * (op[t] - begins) * feeds
            own = way - forced
            left = own * free + forced * fed
            passed, slowed, fills = moves, own * free, fed
            comes_to_rest = left <= stop
            if comes_to_rest:
                left = stop
                if not at_once:
                    passed, slowed, fills = at_rest(own, forced, stop, part_slows, part_fills)
                    passed *= moves
            # Of the actuator's force, then; it may have gone back while the stem was on its way.
            reached = op[t] + (begins - op[t]) * fills - direction * (f_d + left)
            if not comes_to_rest or direction * (reached - x) > 0.0:
                mean = reached
                if not at_once:
                    mean = x * (1.0 - moves) + reached * (moves - passed)
                    mean += (op[t] - direction * f_d) * passed - direction * damping * (own - slowed)
                    mean += supply * (begins - op[t] - direction * forced) * (1.0 - fills)
                x = reached
            if comes_to_rest:
                direction = 0.0
        position[t] = mean
        t += 1
        if comes_to_rest and t > until_rest_after:
            break
    state[0], state[1], state[2], state[3], state[4] = x, force, direction, jump, stop
    return t


@kernel
def settled_force(op: NDArray[np.float64], t: int, supply_keeps: float) -> float:
    """Return the force before sample t; OP (n,) more than ``MEMORY`` samples ago has no effect."""
    first = max(t - MEMORY, 0)
    while first < t and math.isnan(op[first]):
        first += 1
    if first == t:
        return float(op[t])
    force = op[first]
    passes = 1.0 - supply_keeps
    for past in range(first + 1, t):
        if not math.isnan(op[past]):
            force = supply_keeps * force + passes * op[past]
    return float(force)


@kernel
def at_rest(
    own: float, forced: float, stop: float, part_slows: float, part_fills: float
) -> tuple[float, float, float]:
    """Return when a stem comes to rest, and what remains of ``own`` and of a step of OP, by bisection.

    Args:
        own: Way to go at the start that only slows down, OP units.
        forced: Way that the rise of the force adds, OP units.
        stop: Way at which the stem rests, OP units.
        part_slows: Share of ``own`` that remains after a part of the time in which it moves.
        part_fills: Share of ``forced`` that remains then.
    """
    # Shares that remain after a half, a quarter and so on of the time: squares, because roots take five times
    # as long.
    slows_2, fills_2 = part_slows * part_slows, part_fills * part_fills
    slows_4, fills_4 = slows_2 * slows_2, fills_2 * fills_2
    slows_8, fills_8 = slows_4 * slows_4, fills_4 * fills_4
    slows_16, fills_16 = slows_8 * slows_8, fills_8 * fills_8
    filled, passed = 1.0, PART
    for part, slows, fills in (
        (16 * PART, slows_16, fills_16),
        (8 * PART, slows_8, fills_8),
        (4 * PART, slows_4, fills_4),
        (2 * PART, slows_2, fills_2),
        (PART, part_slows, part_fills),
    ):
        slower, fuller = own * slows, filled * fills
        moves_on = slower + forced * fuller > stop
        own = slower if moves_on else own
        filled = fuller if moves_on else filled
        passed = passed + part if moves_on else passed
    return passed, own * part_slows, filled * part_fills


@dataclass(frozen=True, slots=True)
class DampedStem:
    """The damped stem."""

    name: str = "damped_stem"
    reference: str = "after Karnopp, J. of Dynamic Systems, Measurement, and Control 107 (1985) 100"
    damping: float = 0.3
    """Time constant of the stem, samples."""
    supply: float = 0.1
    """Time constant of the air to the actuator, samples."""
    rest: float = 0.01
    """Force over f_D at which the stem stops, over f_S - f_D."""
    give: float = 0.0
    """Of the bristles; 0: stiff."""

    def position(self, op: NDArray[np.float64], bands: FrictionBands, x0: float) -> NDArray[np.float64]:
        """Return the mean valve position over each sample, OP units, shape (n,)."""
        return damped_stem(op, bands.f_s, bands.f_d, x0, self.damping, self.supply, self.rest, self.give)
