"""Time a sample of the kernels of the search, and their share of what the processor could do.

Operations are double-precision products-and-sums, counted by hand from the sources. The clock is measured: in
a chain of products-and-sums each waits for the one before, which takes ``LATENCY`` cycles.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from agent.analysis.quantify.free_run.problem import SLOW, in_spans
from agent.identify.arrays import FloatArray
from agent.identify.gauss_newton import error_at, step_from
from agent.identify.objective import FOPDT, SOPDT, valve_position
from agent.identify.problem import Problem
from agent.identify.process_columns import (
    Passes,
    delayed_products,
    fill_response,
    fill_ways,
    pass_high,
    passes_for,
    response_products,
)
from agent.identify.search.grid import valves_of_grid
from agent.jit import fused_kernel, kernel
from benchmarks.cases.options import Options
from benchmarks.looked_once import window_of
from benchmarks.tables.markdown import table

SEED = 8200
LATENCY = 4
"""Cycles of a product-and-sum (AMD Zen and Intel since Skylake)."""
A_CYCLE = 8
"""Products-and-sums of doubles a cycle at best: two pipes of four lanes (AVX2)."""
REPEATS, RUNS = 20, 400
"""The least of many short runs: a longer one is interrupted on a machine that is shared."""
CHAIN = 1_000
"""Length of the chain in a pass."""


@dataclass(frozen=True, slots=True)
class Kernel:
    """One kernel with what it does for a block of the record."""

    name: str
    call: Callable[[], object]
    operations: int
    """Products-and-sums, or a single one of both; 0: branches decide, so that a count says nothing."""
    moved: int
    """Bytes read and written."""
    waits: int
    """Products-and-sums, each of which waits for that of the block before."""


def run(options: Options) -> None:
    """Print the table for one loop of 1500 samples in blocks of one."""
    del options
    window = window_of(SEED, "stiction")
    problem = in_spans(window, SLOW)
    if isinstance(problem, str):
        raise TypeError(problem)
    valve = valves_of_grid(problem, (FOPDT,)).sorted(1).candidates[0]
    cycle = seconds(lambda: chain(1.0, 0.999, 0.002)) / CHAIN / LATENCY
    rows = [row(each, len(problem.pv), cycle) for each in kernels(problem, valve)]
    columns = (
        "kernel",
        "operations a block",
        "bytes a block",
        "ns a block",
        "share of the peak, %",
        "of the chain, %",
    )
    print(
        table(f"### Kernels of the search, {len(problem.pv)} blocks, {1e-9 / cycle:.1f} GHz", columns, rows)
    )


def kernels(problem: Problem, valve: FloatArray) -> list[Kernel]:
    """Return the kernels, ready to be called on a record and the valve of a candidate."""
    room = passes_for(problem)
    position = valve_position(valve, problem)
    pass_high(position, problem, room.passed)
    ways, products = room.ways, room.products
    return [
        Kernel("valve_position", lambda: valves(valve, problem), 0, 16, 0),
        Kernel("pass_high", lambda: high_passes(position, problem, room), 3, 16, 1),
        Kernel("fill_ways", lambda: all_ways(room.passed, ways), 6, 40, 1),
        Kernel("delayed_products", lambda: all_products(ways, problem, products), 48, 112, 0),
        Kernel("step_from", lambda: steps(valve, problem, room), 54, 152, 1),
        Kernel("fill_response", lambda: responses(room.passed, ways), 3, 24, 1),
        Kernel("response_products", lambda: products_of_response(ways, problem, products), 8, 56, 0),
        Kernel("error_at", lambda: errors(valve, problem, room), 11, 80, 1),
    ]


def row(of: Kernel, blocks: int, cycle: float) -> tuple[str, ...]:
    """Return what is measured of a kernel: time, share of the peak, and share of what its chain allows."""
    a_block = seconds(of.call) / blocks
    peak = f"{100 * of.operations * cycle / A_CYCLE / a_block:.0f}" if of.operations else "branches"
    chained = f"{100 * of.waits * LATENCY * cycle / a_block:.0f}" if of.waits else ""
    return of.name, str(of.operations or ""), str(of.moved), f"{1e9 * a_block:.2f}", peak, chained


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
def valves(valve: FloatArray, problem: Problem) -> None:
    """Repeat the stem."""
    for _ in range(REPEATS):
        valve_position(valve, problem)


@kernel
def high_passes(position: FloatArray, problem: Problem, room: Passes) -> None:
    """Repeat the high pass."""
    for _ in range(REPEATS):
        pass_high(position, problem, room.passed)


@kernel
def all_ways(passed: FloatArray, ways: FloatArray) -> None:
    """Repeat response, derivatives and start-up."""
    for _ in range(REPEATS):
        fill_ways(passed, 0.9, 0.5, ways)


@kernel
def responses(passed: FloatArray, ways: FloatArray) -> None:
    """Repeat response and start-up."""
    for _ in range(REPEATS):
        fill_response(passed, 0.9, 0.5, ways)


@kernel
def all_products(ways: FloatArray, problem: Problem, products: FloatArray) -> None:
    """Repeat the sums over all columns."""
    for _ in range(REPEATS):
        delayed_products(ways, 5, 0.4, problem, products)


@kernel
def products_of_response(ways: FloatArray, problem: Problem, products: FloatArray) -> None:
    """Repeat the sums over the response."""
    for _ in range(REPEATS):
        response_products(ways, 5, 0.4, problem, products)


@kernel
def steps(valve: FloatArray, problem: Problem, room: Passes) -> None:
    """Repeat a whole pass with its step."""
    for _ in range(REPEATS):
        step_from(valve, SOPDT, problem, 1.0, room)


@kernel
def errors(valve: FloatArray, problem: Problem, room: Passes) -> None:
    """Repeat the last pass."""
    for _ in range(REPEATS):
        error_at(valve, SOPDT, problem, 1.0, room)


@fused_kernel
def chain(value: float, keeps: float, adds: float) -> float:
    """Return the end of a chain of products-and-sums."""
    for _ in range(REPEATS * CHAIN):
        value = keeps * value + adds
    return value
