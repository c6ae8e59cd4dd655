"""Time a sample of the kernels of the search, and their share of what the processor could do.

Operations are double-precision products-and-sums, counted by hand from the sources. The clock is measured: in
a chain of products-and-sums each waits for the one before, which takes ``LATENCY`` cycles.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from agent.analysis.quantify.free_run.problem import SLOW, in_spans
from agent.identify.arrays import FloatArray, IntArray
from agent.identify.objective import FOPDT, valve_position
from agent.identify.problem import Problem
from agent.identify.search.children import generation
from agent.identify.search.cycle import STRUCTURES, possible_of
from agent.identify.search.grid import valves_of_grid
from agent.identify.side_by_side.gauss_newton import (
    GIVE_UP,
    ProcessFits,
    fit_processes,
    fits_for,
    processes_at,
)
from agent.identify.side_by_side.positions import CandidateGroup, alike, fill_positions, group_for, pass_high
from agent.identify.side_by_side.process_columns import (
    delay_paths,
    fill_columns,
    fill_response,
    products_of_columns,
    products_of_start_up,
    products_with_nuisance,
)
from agent.identify.side_by_side.process_step import steps_of
from agent.jit import fused_kernel, kernel
from agent.lanes import WIDTH, splat
from benchmarks.cases.options import Options
from benchmarks.looked_once import window_of
from benchmarks.tables.markdown import table

SEED = 8200
LATENCY = 4
"""Cycles of a product-and-sum (AMD Zen and Intel since Skylake)."""
A_CYCLE = 16
"""Products-and-sums of doubles a cycle at best: two pipes of eight lanes (AVX-512)."""
REPEATS, RUNS = 5, 400
"""The least of many short runs: a longer one is interrupted on a machine that is shared."""
CHAIN = 1_000
"""Length of the chain in a pass."""


@dataclass(frozen=True, slots=True)
class Kernel:
    """One kernel with what it does for a block of the record of one candidate."""

    name: str
    call: Callable[[], object]
    operations: int
    """Products-and-sums, or a single one of both; 0: branches decide, so that a count says nothing."""
    moved: int
    """Bytes read and written."""
    waits: int
    """Products-and-sums, each of which waits for that of the block before."""


def run(options: Options) -> None:
    """Print the table for one loop of 1500 samples in blocks of one, and children of one generation."""
    del options
    window = window_of(SEED, "stiction")
    problem = in_spans(window, SLOW)
    if isinstance(problem, str):
        raise TypeError(problem)
    cycle = seconds(lambda: chain(1.0, 0.999, 0.002)) / CHAIN / LATENCY
    rows = [row(each, len(problem.pv), cycle) for each in kernels(problem)]
    columns = (
        "kernel",
        "operations a block",
        "bytes a block",
        "ns a block",
        "share of the peak, %",
        "of the chain, %",
    )
    title = f"### Kernels of the search, a candidate, {len(problem.pv)} blocks, {1e-9 / cycle:.1f} GHz"
    print(table(title, columns, rows))


def kernels(problem: Problem) -> list[Kernel]:
    """Return the kernels, ready to be called on a record and a group of candidates."""
    parents = valves_of_grid(problem, (FOPDT,)).sorted(20)
    rng = np.random.default_rng(SEED)
    grown = generation(parents, 12, 0.02, problem, possible_of(STRUCTURES), rng)
    places = alike(grown.candidates, 0, len(grown.costs))[:WIDTH]
    group, fits = group_for(problem), fits_for(problem)
    fits.values[GIVE_UP] = np.inf
    members = Members(grown.candidates, grown.structures, places)
    one = grown.candidates[places[0]]
    positions(members, problem, group)
    high_passes(problem, group)
    delays(members, problem, group, fits)
    return [
        Kernel("one stem alone", lambda: alone(one, problem), 0, 16 * WIDTH, 0),
        Kernel("stems", lambda: positions(members, problem, group), 0, 16, 0),
        Kernel("high pass", lambda: high_passes(problem, group), 3, 16, 1),
        Kernel("delay", lambda: delays(members, problem, group, fits), 0, 16, 0),
        Kernel("response and its derivatives", lambda: columns_of(problem, fits), 16, 40, 1),
        Kernel("their sums of products", lambda: sums(problem, fits), 14, 32, 1),
        Kernel("with the nuisance", lambda: with_nuisance(problem, fits), 12, 32, 1),
        Kernel("with the start-up", lambda: with_start_up(problem, fits), 0, 32, 1),
        Kernel("last pass: response and sums", lambda: responses(problem, fits), 10, 16, 1),
        Kernel("steps", lambda: steps(members, problem, fits), 0, 0, 0),
        Kernel("a fit of three passes", lambda: all_of_it(members, problem, group, fits), 0, 0, 0),
    ]


class Members(NamedTuple):
    """Candidates of a group."""

    candidates: FloatArray
    structures: IntArray
    places: IntArray


def row(of: Kernel, blocks: int, cycle: float) -> tuple[str, ...]:
    """Return what is measured of a kernel: time, share of the peak, and share of what its chain allows."""
    a_block = seconds(of.call) / blocks / WIDTH
    peak = f"{100 * of.operations * cycle / A_CYCLE / a_block:.0f}" if of.operations else ""
    chained = f"{100 * of.waits * LATENCY * cycle / WIDTH / a_block:.0f}" if of.waits else ""
    return of.name, str(of.operations or ""), str(of.moved or ""), f"{1e9 * a_block:.2f}", peak, chained


def seconds(call: Callable[[], object]) -> float:
    """Return the least time of one of the ``REPEATS`` passes of a call, s."""
    call()
    least = np.inf
    for _ in range(RUNS):
        started = time.perf_counter()
        call()
        least = min(least, (time.perf_counter() - started) / REPEATS)
    return float(least)


# Each repeats one kernel in compiled code: to call it from Python takes as long as some of them.


@kernel
def alone(valve: FloatArray, problem: Problem) -> None:
    """Repeat one stem as often as there are lanes."""
    for _ in range(REPEATS * WIDTH):
        valve_position(valve, problem)


@kernel
def positions(members: Members, problem: Problem, group: CandidateGroup) -> None:
    """Repeat the stems."""
    for _ in range(REPEATS):
        fill_positions(members.candidates, members.places, problem, group)


@kernel
def high_passes(problem: Problem, group: CandidateGroup) -> None:
    """Repeat the high pass."""
    for _ in range(REPEATS):
        pass_high(problem, group)


@kernel
def delays(members: Members, problem: Problem, group: CandidateGroup, fits: ProcessFits) -> None:
    """Repeat the delays."""
    processes = processes_at(members.candidates, members.structures, members.places, fits)
    for _ in range(REPEATS):
        delay_paths(processes, group.passed, problem, fits.passes)


@kernel
def columns_of(problem: Problem, fits: ProcessFits) -> None:
    """Repeat response and derivatives."""
    for _ in range(REPEATS):
        fill_columns(splat(0.9), splat(0.5), splat(0.4), problem, fits.passes)


@kernel
def sums(problem: Problem, fits: ProcessFits) -> None:
    """Repeat the sums over the columns."""
    for _ in range(REPEATS):
        products_of_columns(problem, fits.passes)


@kernel
def with_nuisance(problem: Problem, fits: ProcessFits) -> None:
    """Repeat those with the nuisance."""
    for _ in range(REPEATS):
        products_with_nuisance(problem, fits.passes)


@kernel
def with_start_up(problem: Problem, fits: ProcessFits) -> None:
    """Repeat those with the start-up."""
    pole = splat(0.9)
    for _ in range(REPEATS):
        products_of_start_up(pole, pole > 0.0, problem, fits.passes)


@kernel
def responses(problem: Problem, fits: ProcessFits) -> None:
    """Repeat response and its sums."""
    for _ in range(REPEATS):
        fill_response(splat(0.9), splat(0.5), splat(0.4), problem, fits.passes)


@kernel
def steps(members: Members, problem: Problem, fits: ProcessFits) -> None:
    """Repeat the steps."""
    processes = processes_at(members.candidates, members.structures, members.places, fits)
    for _ in range(REPEATS):
        steps_of(processes, problem, fits.squares, fits.passes, fits.normal)


@kernel
def all_of_it(members: Members, problem: Problem, group: CandidateGroup, fits: ProcessFits) -> None:
    """Repeat whole fits."""
    for _ in range(REPEATS):
        fit_processes(members.candidates, members.structures, members.places, problem, 3, group.passed, fits)


@fused_kernel
def chain(value: float, keeps: float, adds: float) -> float:
    """Return the end of a chain of products-and-sums."""
    for _ in range(REPEATS * CHAIN):
        value = keeps * value + adds
    return value
