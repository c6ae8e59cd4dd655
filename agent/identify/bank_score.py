"""The share of PV that the best process of a bank explains behind a valve.

Between two delays the response is interpolated, with both parts fitted.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from agent.identify.arrays import FloatArray, IntArray
from agent.identify.bank import GROUP, Bank
from agent.jit import fused_kernel, kernel, summing_kernel

SEEN = 1e-3
"""Share of a response that must remain beside level and end of the filter's memory."""


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


@fused_kernel
def response_sums(
    means: FloatArray,
    bank: Bank,
    delays: IntArray,
    sums: FloatArray,
) -> None:
    """Fill ``sums`` (3, delays, k): of the response z of each process, of z^2 and of z keep^t.

    Over the samples that count once it is delayed; ``delays`` ascend, so that they end the sums early.
    A ``GROUP`` of processes goes through the record side by side. Their states and sums lie in one array, at
    distances that the compiler knows, so it takes several of them at once.
    """
    m = means.size
    state = np.empty(8 * GROUP)
    sums[:] = 0.0
    for group in range(0, bank.poles.size, GROUP):
        state[:GROUP] = bank.poles[group : group + GROUP]
        state[GROUP : 2 * GROUP] = bank.second[group : group + GROUP]
        state[2 * GROUP : 3 * GROUP] = bank.gains[group : group + GROUP]
        state[3 * GROUP :] = 0.0
        high, former, memory = 0.0, means[0], 1.0
        begin = end = delays.size - 1
        t = 0
        while end >= 0:
            if begin >= 0 and t >= bank.burn - delays[begin]:
                add_sums(sums, begin, group, -1.0, state)
                begin -= 1
                continue
            until = m - delays[end]
            if t >= until:
                add_sums(sums, end, group, 1.0, state)
                end -= 1
                continue
            if begin >= 0:
                until = min(until, bank.burn - delays[begin])
            for u in range(t, until):
                high = bank.keep * high + bank.keep * (means[u] - former)
                former = means[u]
                for i in range(GROUP):
                    first = state[i] * state[3 * GROUP + i] + state[2 * GROUP + i] * high
                    z = state[GROUP + i] * state[4 * GROUP + i] + first
                    state[3 * GROUP + i] = first
                    state[4 * GROUP + i] = z
                    state[5 * GROUP + i] += z
                    state[6 * GROUP + i] += z * z
                    state[7 * GROUP + i] += z * memory
                memory *= bank.keep
            t = until


@kernel
def add_sums(sums: FloatArray, q: int, group: int, times: float, state: FloatArray) -> None:
    """Add the sums of a group of processes so far at the delay ``q``."""
    for kind in range(3):
        for i in range(GROUP):
            sums[kind, q, group + i] += times * state[(5 + kind) * GROUP + i]


@summing_kernel
def covariances(
    at: IntArray, by: FloatArray, moves: int, delayed: FloatArray, covariance: FloatArray
) -> None:
    """Fill the covariance of PV with each delayed response, (delays * k,).

    Args:
        at: Blocks of the moves, (moves or more,).
        by: The moves, OP units, likewise.
        moves: How many there are.
        delayed: The bank's sums at each delay side by side, (m, delays * k).
        covariance: Filled. Several moves at a time, so that it is loaded less often.
    """
    covariance[:] = 0.0
    whole = moves - moves % 4
    for j in range(0, whole, 4):
        a, b, c, d = by[j], by[j + 1], by[j + 2], by[j + 3]
        of_a, of_b, of_c, of_d = delayed[at[j]], delayed[at[j + 1]], delayed[at[j + 2]], delayed[at[j + 3]]
        for i in range(covariance.size):
            covariance[i] += a * of_a[i] + b * of_b[i] + c * of_c[i] + d * of_d[i]
    for j in range(whole, moves):
        a, of_a = by[j], delayed[at[j]]
        for i in range(covariance.size):
            covariance[i] += a * of_a[i]


@fused_kernel
def best_process(
    response: FloatArray, covariance: FloatArray, fading: FloatArray, bank: Bank
) -> tuple[float, int, int]:
    """Return the largest explained share of PV with its places among delays and poles.

    Args:
        response: From ``response_sums``, (3, delays, k).
        covariance: (delays, k).
        fading: The pole of the high pass to the power of each delay, (delays,).
        bank: The processes.
    """
    best = 0.0
    best_q = 0
    best_i = 0
    level, both, end = bank.gram[0, 0], bank.gram[0, 1], bank.gram[1, 1]
    for q in range(covariance.shape[0]):
        for i in range(covariance.shape[1]):
            shared = covariance[q, i]
            if shared * bank.gain_sign < 0.0:
                continue
            plain, square, slow = response[0, q, i], response[1, q, i], fading[q] * response[2, q, i]
            left = square - (level * plain * plain + 2.0 * both * plain * slow + end * slow * slow)
            if left > SEEN * square and shared * shared > best * left:
                best = shared * shared / left
                best_q = q
                best_i = i
    return best / bank.squares, best_q, best_i


class Room(NamedTuple):
    """What the scores of one bank at the same delays share: a table, and room."""

    delayed: FloatArray
    """The bank's sums at each delay side by side, PV units, (m, delays * k)."""
    fading: FloatArray
    """The pole of the high pass to the power of each delay, (delays,)."""
    means: FloatArray
    at: IntArray
    by: FloatArray
    response: FloatArray
    covariance: FloatArray


@kernel
def room_for(bank: Bank, delays: IntArray) -> Room:
    """Return the table and room for the bank at these delays."""
    m = bank.op.size // bank.block
    k = bank.poles.size
    delayed = np.empty((m, delays.size * k))
    fading = np.empty(delays.size)
    for q in range(delays.size):
        fading[q] = bank.keep ** delays[q]
        delayed[:, q * k : (q + 1) * k] = bank.sums[delays[q] : delays[q] + m]
    return Room(
        delayed,
        fading,
        np.empty(m),
        np.empty(m, np.int64),
        np.empty(m),
        np.empty((3, delays.size, k)),
        np.empty(delays.size * k),
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
    response_sums(room.means, bank, delays, room.response)
    covariances(room.at, room.by, moves, room.delayed, room.covariance)
    covariance = room.covariance.reshape(delays.size, bank.poles.size)
    best, q, pole = best_process(room.response, covariance, room.fading, bank)
    return best, pole * delays.size + q
