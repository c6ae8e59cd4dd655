"""The share of PV that the best process of a bank explains behind a valve.

Between two delays the response is interpolated, with both parts fitted.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from agent.identify.arrays import FloatArray, IntArray
from agent.identify.bank import Bank
from agent.jit import fused_kernel, inlined_kernel, kernel, summing_kernel


@summing_kernel
def moves_of(position: FloatArray, block: int, means: FloatArray, at: IntArray, by: FloatArray) -> int:
    """Fill the block means of the position less its first value, and its moves; return their number."""
    m = means.size
    start = position[0]
    former = 0.0
    moves = 0
    for b in range(m):
        mean = position[b] - start
        if block > 1:
            mean = 0.0
            for t in range(b * block, (b + 1) * block):
                mean += position[t]
            mean = mean / block - start
        means[b] = mean
        if mean != former:
            at[moves] = b
            by[moves] = mean - former
            moves += 1
        former = mean
    return moves


class Running(NamedTuple):
    """One response so far, and its sums."""

    first: float
    """Of the first lag, OP units."""
    z: float
    """The response, OP units."""
    plain: float
    squares: float
    slow: float
    """Times keep^t."""
    neighbours: float
    """Times the one before."""


@inlined_kernel
def moved_on(so_far: Running, pole: float, second: float, passed: float, fading: float) -> Running:
    """Return the sums with one more block; ``passed`` is the position high-passed, times the gain."""
    first = pole * so_far.first + passed
    z = second * so_far.z + first
    return Running(
        first,
        z,
        so_far.plain + z,
        so_far.squares + z * z,
        so_far.slow + z * fading,
        so_far.neighbours + z * so_far.z,
    )


@kernel
def add_sums(sums: FloatArray, q: int, i: int, times: float, running: Running) -> None:
    """Add the sums of a response at the delay ``q`` and the pole ``i``."""
    sums[0, q, i] += times * running.plain
    sums[1, q, i] += times * running.squares
    sums[2, q, i] += times * running.slow
    sums[3, q, i] += times * running.neighbours


@fused_kernel
def response_sums(
    means: FloatArray,
    keep: float,
    poles: FloatArray,
    second: FloatArray,
    gains: FloatArray,
    delays: IntArray,
    burn: int,
    sums: FloatArray,
) -> None:
    """Fill ``sums`` (4, delays, poles): of the response z, z^2, z keep^t and z(t) z(t-1).

    Over the samples that count once it is delayed; ``delays`` ascend, so that they end the sums early. Two
    processes at a time: their filters wait for themselves only, and all their sums stay in registers.
    """
    m = means.size
    passed = np.empty(m)
    fading = np.empty(m)
    high, former, memory = 0.0, means[0], 1.0
    for t in range(m):
        high = keep * high + keep * (means[t] - former)
        former = means[t]
        passed[t], fading[t] = high, memory
        memory *= keep
    sums[:] = 0.0
    for i in range(0, poles.size, 2):
        j = min(i + 1, poles.size - 1)
        one = Running(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
        other = one
        begin = end = delays.size - 1
        t = 0
        while end >= 0:
            if begin >= 0 and t >= burn - delays[begin]:
                add_sums(sums, begin, i, -1.0, one)
                if j > i:
                    add_sums(sums, begin, j, -1.0, other)
                begin -= 1
                continue
            until = m - delays[end]
            if t >= until:
                add_sums(sums, end, i, 1.0, one)
                if j > i:
                    add_sums(sums, end, j, 1.0, other)
                end -= 1
                continue
            if begin >= 0:
                until = min(until, burn - delays[begin])
            for u in range(t, until):
                one = moved_on(one, poles[i], second[i], gains[i] * passed[u], fading[u])
                other = moved_on(other, poles[j], second[j], gains[j] * passed[u], fading[u])
            t = until


@summing_kernel
def covariances(
    at: IntArray,
    by: FloatArray,
    moves: int,
    sums: FloatArray,
    places: IntArray,
    delays: IntArray,
    covariance: FloatArray,
) -> None:
    """Fill the covariance of PV with each delayed response, (delays, poles)."""
    covariance[:] = 0.0
    for j in range(moves):
        move = by[j]
        for q in range(delays.size):
            row = at[j] + delays[q]
            for i in range(places.size):
                covariance[q, i] += move * sums[row, places[i]]


@kernel
def without_nuisance(
    product: float, a: tuple[float, float], b: tuple[float, float], gram: FloatArray
) -> float:
    """Return the product of two responses less what level and end of the filter's memory take of it.

    ``a`` and ``b`` are the products of each response with these two.
    """
    taken = gram[0, 0] * a[0] * b[0] + gram[0, 1] * (a[0] * b[1] + a[1] * b[0]) + gram[1, 1] * a[1] * b[1]
    return float(product - taken)


@kernel
def best_process(
    response: FloatArray, covariance: FloatArray, delays: IntArray, bank: Bank
) -> tuple[float, int, int]:
    """Return the largest explained share of PV with its places among delays and poles."""
    best = 0.0
    best_q = 0
    best_i = 0
    for q in range(delays.size):
        fading = bank.keep ** delays[q]
        for i in range(covariance.shape[1]):
            if covariance[q, i] * bank.gain_sign < 0.0:
                continue
            slow = (response[0, q, i], fading * response[2, q, i])
            left = without_nuisance(response[1, q, i], slow, slow, bank.gram)
            if left > 1e-3 * response[1, q, i]:
                share = covariance[q, i] ** 2 / left / bank.squares
                if share > best:
                    best = share
                    best_q = q
                    best_i = i
    return best, best_q, best_i


class Room(NamedTuple):
    """Room for what a score needs, so that scores of one bank at the same delays share it."""

    means: FloatArray
    at: IntArray
    by: FloatArray
    response: FloatArray
    covariance: FloatArray
    every: IntArray
    """The places of all processes."""


@kernel
def room_for(bank: Bank, delays: IntArray) -> Room:
    """Return room for the bank at these delays."""
    m = bank.op.size // bank.block
    k = bank.poles.size
    return Room(
        np.empty(m),
        np.empty(m, np.int64),
        np.empty(m),
        np.empty((4, delays.size, k)),
        np.empty((delays.size, k)),
        np.arange(k),
    )


@kernel
def best_share(
    position: FloatArray, bank: Bank, delays: IntArray, least_moves: int, room: Room
) -> tuple[float, int]:
    """Return the share of PV that the best process explains behind a position, and its place, process first.

    0 where the position (n,) moves less often than ``least_moves``; ``delays`` in blocks, ascending.
    """
    moves = moves_of(position, bank.block, room.means, room.at, room.by)
    if moves < least_moves:
        return 0.0, 0
    response_sums(
        room.means, bank.keep, bank.poles, bank.second, bank.gains, delays, bank.burn, room.response
    )
    covariances(room.at, room.by, moves, bank.sums, room.every, delays, room.covariance)
    best, q, pole = best_process(room.response, room.covariance, delays, bank)
    return best, pole * delays.size + q
