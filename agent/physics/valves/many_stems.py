"""Many damped stems side by side: ``damped_stem`` of ``WIDTH`` valves on the same OP.

A stem that moves takes steps that wait for each other; ``WIDTH`` stems take them in the lanes of a vector, in
little more time than one. While all rest, only the nearest break-away is looked for. So it is fastest where
the valves are alike and slip at nearly the same times.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from agent.jit import kernel
from agent.lanes import (
    Lanes,
    Mask,
    Rows,
    any_of,
    choose,
    exp,
    larger,
    least_of,
    load,
    log,
    most_of,
    no_lane,
    smaller,
    splat,
    store,
    where,
)
from agent.physics.valves.damped_stem import AT_ONCE, HALLEY, MEMORY, PART, SQUARINGS

F_S, F_D, X0, DAMPING, SUPPLY, REST, GIVE = range(7)
"""Rows of what ``move_stems`` takes of its valves, with the units of ``damped_stem``."""
VALUES = 7
LEAST = 1e-300
"""Stands for a zero whose logarithm is taken."""


class StemsAtOnce(NamedTuple):
    """What every sample needs, as in ``damped_stem.Motion`` and ``damped_stem.strokes``."""

    f_s: Lanes
    f_d: Lanes
    damping: Lanes
    supply: Lanes
    jump: Lanes
    """f_S - f_D, OP units."""
    stop: Lanes
    """Way at which a stem rests, OP units."""
    damping_keeps: Lanes
    supply_keeps: Lanes
    feeds: Lanes
    part_slows: Lanes
    part_fills: Lanes
    at_once: Mask
    gives: Mask
    lead: Lanes
    nearest: Lanes
    """Part of a step of OP at which bristles are nearest to break-away, OP units."""


class SlipsAtOnce(NamedTuple):
    """Motion through a sample, from where it begins."""

    begins: Lanes
    """Force of the actuator, OP units."""
    way: Lanes
    """To go, OP units."""
    free: Lanes
    """Share of a distance that remains at the end of the sample."""
    fed: Lanes
    """Share of a step of OP that remains."""
    moves: Lanes
    """Part of the sample in which it moves."""
    part_slows: Lanes
    part_fills: Lanes


@kernel
def move_stems(op: NDArray[np.float64], valves: Rows, position: Rows) -> None:
    """Fill the mean positions of all stems over each sample, OP units.

    Args:
        op: Controller output, OP units, nowhere NaN, (n,).
        valves: ``VALUES`` rows; the stem rests at first.
        position: (n, ``WIDTH``).
    """
    stems = stems_of(valves)
    x, force, direction, moving = load(valves, X0), splat(op[0]), splat(0.0), no_lane()
    reach = stems.f_s - 4.0 / 27.0 * (stems.lead * stems.lead * stems.lead)
    t = 0
    while t < op.size:
        if not any_of(moving | (force - x > reach) | (x - force > reach)):
            low, high = most_of(x - reach), least_of(x + reach)
            while t < op.size and low <= op[t] <= high:
                store(position, t, x)
                t += 1
            if t == op.size:
                break
        u = op[t]
        before = where(moving, force, settled_forces(op, t, stems.supply_keeps))
        force = u + (before - u) * stems.supply_keeps
        toward = where(force > x, 1.0, -1.0)
        left_then, breaks = break_aways(u, before, force, x, toward, moving, stems)
        starts = breaks & ~moving
        direction = where(starts, toward, direction)
        slip = slips(u, before, x, direction, left_then, starts, stems)
        halts = (slip.way <= stems.stop) & (direction * (force - x) - stems.f_d <= stems.stop)
        moving = choose(moving, ~halts, starts)
        x, mean, moving = moved(u, x, direction, moving, slip, stems)
        store(position, t, mean)
        t += 1


@kernel
def stems_of(valves: Rows) -> StemsAtOnce:
    """Return what every sample needs of the valves."""
    f_s, f_d, rest, give = load(valves, F_S), load(valves, F_D), load(valves, REST), load(valves, GIVE)
    damping, supply = load(valves, DAMPING), load(valves, SUPPLY)
    jump = f_s - f_d
    stop = smaller(rest * jump, jump)
    gives = (give > 0.0) & (jump > 0.0)
    lead = where(gives, 3.0 * cube_root(jump * give * give), 0.0)
    ratio = larger(jump - stop, LEAST) / larger(lead, LEAST)
    alike = (supply - damping < 1e-6 * damping) & (damping - supply < 1e-6 * damping)
    supply = where(alike, supply * (1.0 + 1e-5), supply)
    return StemsAtOnce(
        f_s,
        f_d,
        damping,
        supply,
        jump,
        stop,
        exp(-1.0 / damping),
        exp(-1.0 / supply),
        damping / (supply - damping),
        exp(-PART / damping),
        exp(-PART / supply),
        damping + supply < AT_ONCE,
        gives,
        lead,
        smaller(8.0 / 27.0 * (lead * lead * lead), where(gives, exp(1.5 * log(ratio)), 0.0)),
    )


@kernel
def cube_root(number: Lanes) -> Lanes:
    """Return the cube root of numbers that are not negative."""
    return exp(log(larger(number, LEAST)) * (1.0 / 3.0))


@kernel
def settled_forces(op: NDArray[np.float64], t: int, supply_keeps: Lanes) -> Lanes:
    """Return the forces before sample t behind stems that rest, OP units."""
    first = max(t - MEMORY, 0)
    force = splat(op[first])
    passes = 1.0 - supply_keeps
    for past in range(first + 1, t):
        force = supply_keeps * force + passes * op[past]
    return force


@kernel
def break_aways(
    u: float, before: Lanes, force: Lanes, x: Lanes, toward: Lanes, moving: Mask, stems: StemsAtOnce
) -> tuple[Lanes, Mask]:
    """Return what is still to come of the step of OP where resting stems break away, and which do.

    See ``damped_stem.left_at_break_away``.
    """
    step, over = toward * (u - before), toward * (u - x) - stems.f_s
    breaks = toward * (force - x) > stems.f_s
    bends = stems.gives & (step > 0.0) & ~moving
    if not any_of(bends):
        return over, breaks
    lead, most = stems.lead, stems.jump - stems.stop
    least = smaller(larger(stems.nearest, step * stems.supply_keeps), step)
    root = cube_root(least)
    holds = over - least + smaller(lead * root * root, most) < 0.0
    z = cube_root(smaller(step, over + most))
    for _ in range(HALLEY):
        excess, slope, bend = (z - lead) * z * z - over, (3.0 * z - 2.0 * lead) * z, 6.0 * z - 2.0 * lead
        nearer = z - 2.0 * excess * slope / (2.0 * slope * slope - excess * bend)
        z = where(excess > 0.0, nearer, z)
    left_then = where(holds, 0.0, larger(z * z * z, least))
    return where(bends, left_then, over), choose(bends, left_then > 0.0, breaks)


@kernel
def slips(
    u: float, before: Lanes, x: Lanes, direction: Lanes, left_then: Lanes, starts: Mask, stems: StemsAtOnce
) -> SlipsAtOnce:
    """Return the motion of each stem through the sample, if it moves."""
    begins, way = before, direction * (before - x) - stems.f_d
    free, fed, moves = stems.damping_keeps, stems.supply_keeps, splat(1.0)
    part_slows, part_fills = stems.part_slows, stems.part_fills
    step = direction * (u - before)
    within = starts & ~stems.at_once & (step > left_then)
    if any_of(within):
        over = direction * (u - x) - stems.f_s
        share = where(within, left_then, 1.0) / where(within, step, 1.0)
        begins = where(within, u - direction * left_then, begins)
        way = where(within, stems.jump + (over - left_then), way)
        fed = where(within, stems.supply_keeps / share, fed)
        moves = 1.0 + stems.supply * log(share)
        part_slows = exp(-PART * moves / stems.damping)
        part_fills = exp(-PART * moves / stems.supply)
        through = part_slows
        for _ in range(SQUARINGS):
            through = through * through
        free = where(within, through, free)
    return SlipsAtOnce(begins, way, free, fed, moves, part_slows, part_fills)


@kernel
def moved(
    u: float, x: Lanes, direction: Lanes, moving: Mask, slip: SlipsAtOnce, stems: StemsAtOnce
) -> tuple[Lanes, Lanes, Mask]:
    """Return the positions at the end of the sample, their means over it, and which stems go on."""
    forced = direction * (u - slip.begins) * stems.feeds
    own = slip.way - forced
    slowed, fills, passed = own * slip.free, slip.fed, slip.moves
    left = slowed + forced * fills
    rests = moving & (left <= stems.stop)
    left = where(rests, stems.stop, left)
    if any_of(rests):
        later, slower, fuller = rest_times(own, forced, stems.stop, slip.part_slows, slip.part_fills)
        in_time = rests & ~stems.at_once
        passed = where(in_time, later * slip.moves, passed)
        slowed = where(in_time, slower, slowed)
        fills = where(in_time, fuller, fills)
    reached = u + (slip.begins - u) * fills - direction * (stems.f_d + left)
    goes = moving & (~rests | (direction * (reached - x) > 0.0))
    mean = x * (1.0 - slip.moves) + reached * (slip.moves - passed)
    mean = mean + (u - direction * stems.f_d) * passed - direction * stems.damping * (own - slowed)
    mean = mean + stems.supply * (slip.begins - u - direction * forced) * (1.0 - fills)
    mean = where(stems.at_once, reached, mean)
    return where(goes, reached, x), where(goes, mean, x), moving & ~rests


@kernel
def rest_times(
    own: Lanes, forced: Lanes, stop: Lanes, part_slows: Lanes, part_fills: Lanes
) -> tuple[Lanes, Lanes, Lanes]:
    """Return when stems come to rest, and what remains then: ``damped_stem.at_rest``."""
    slows_2, fills_2 = part_slows * part_slows, part_fills * part_fills
    slows_4, fills_4 = slows_2 * slows_2, fills_2 * fills_2
    slows_8, fills_8 = slows_4 * slows_4, fills_4 * fills_4
    passed, filled = splat(PART), splat(1.0)
    for part, slows, fills in (
        (16 * PART, slows_8 * slows_8, fills_8 * fills_8),
        (8 * PART, slows_8, fills_8),
        (4 * PART, slows_4, fills_4),
        (2 * PART, slows_2, fills_2),
        (PART, part_slows, part_fills),
    ):
        slower, fuller = own * slows, filled * fills
        moves_on = slower + forced * fuller > stop
        own, filled = where(moves_on, slower, own), where(moves_on, fuller, filled)
        passed = where(moves_on, passed + part, passed)
    return passed, own * part_slows, filled * part_fills
