"""Stem positions of many candidates on one record, as many at a time as ``lanes`` holds."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from agent.identify.arrays import FloatArray, IntArray
from agent.identify.objective import S, valve_of
from agent.identify.problem import Problem
from agent.jit import kernel
from agent.lanes import WIDTH, Rows, fused, load, splat, store
from agent.physics.valves.many_stems import DAMPING, F_D, F_S, GIVE, REST, SUPPLY, VALUES, X0, move_stems


class CandidateGroup(NamedTuple):
    """Room for the candidates of one group on one record."""

    valves: Rows
    """As ``move_stems`` takes them, (``VALUES``, ``WIDTH``)."""
    positions: Rows
    """Of their stems, OP units, (n, ``WIDTH``)."""
    passed: Rows
    """Block means of the positions behind the filters, but for a factor, OP units, (m, ``WIDTH``)."""


@kernel
def group_for(problem: Problem) -> CandidateGroup:
    """Return room for a record."""
    n, m = problem.op.size, problem.pv.size
    return CandidateGroup(np.empty((VALUES, WIDTH)), np.empty((n, WIDTH)), np.empty((m, WIDTH)))


@kernel
def alike(candidates: FloatArray, begin: int, end: int) -> IntArray:
    """Return the places from ``begin`` up to ``end`` so that those with nearly the same S stand together.

    Stems that slip at nearly the same times take the least time side by side.
    """
    return begin + np.argsort(candidates[begin:end, S], kind="mergesort")


@kernel
def fill_positions(candidates: FloatArray, places: IntArray, problem: Problem, group: CandidateGroup) -> None:
    """Fill the positions (``valve_position``) of the candidates at up to ``WIDTH`` places, at least one."""
    for lane in range(WIDTH):
        valve = valve_of(candidates[places[min(lane, places.size - 1)]])
        group.valves[F_S, lane], group.valves[F_D, lane] = valve.f_s, valve.f_d
        group.valves[X0, lane], group.valves[GIVE, lane] = valve.x0, valve.give
        group.valves[DAMPING, lane], group.valves[SUPPLY, lane] = valve.damping, valve.supply
        group.valves[REST, lane] = valve.rest
    move_stems(problem.op, group.valves, group.positions)
    for lane in range(places.size):
        if candidates[places[lane], S] == 0.0:
            group.positions[:, lane] = problem.op


@kernel
def pass_filters(problem: Problem, group: CandidateGroup) -> None:
    """Fill ``passed`` with the block means of the positions behind the filters, but for the factor of one."""
    pass_high(problem, group)
    if problem.whitening.size:
        whiten(problem.whitening, group.passed)


@kernel
def pass_high(problem: Problem, group: CandidateGroup) -> None:
    """Fill ``passed`` with the block means of the positions behind the high pass, but for its factor."""
    positions, block, share = group.positions, problem.block, 1.0 / problem.block
    former = high = splat(0.0)
    for b in range(len(group.passed)):
        total = load(positions, b * block)
        for t in range(b * block + 1, (b + 1) * block):
            total = total + load(positions, t)
        mean = total * share
        if b > 0:
            high = fused(problem.keep, high, mean - former)
        former = mean
        store(group.passed, b, high)


@kernel
def whiten(coefficients: FloatArray, series: Rows) -> None:
    """Take from each block what an autoregression (p,) predicts of it, in place; before it all were zero."""
    for b in range(len(series) - 1, 0, -1):
        left = load(series, b)
        for lag in range(1, min(coefficients.size, b) + 1):
            left = fused(-coefficients[lag - 1], load(series, b - lag), left)
        store(series, b, left)
