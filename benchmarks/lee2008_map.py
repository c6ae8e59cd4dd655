"""The map of ``lee2008``, compiled, against the same in NumPy: valves at 1 % of the OP span, ten delays."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.quantify.processes.output_error import FIRST_ORDER, SECOND_ORDER, output_errors
from agent.analysis.quantify.valves.bounded_search import grid
from agent.analysis.quantify.valves.valve_law import HE
from benchmarks.cases.cpu_time import seconds
from benchmarks.cases.options import Options
from benchmarks.table_one import MEANS
from benchmarks.tables.markdown import table
from simulators.draws.random_plants import random_plant
from simulators.plant import simulate
from tests.reference.lee2008_numpy import map_at_once, map_by_candidate

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray

DELAYS = np.arange(1, 11)
ORDERS = {FIRST_ORDER: "order 1", SECOND_ORDER: "order 2"}
SEED = 1000

NumpyMap = Callable[..., "FloatArray"]


def run(_options: Options) -> None:
    """Print a row for each length and order."""
    rows = []
    for samples in (1000, 2000):
        op, pv = sticking_loop(SEED, samples)
        for (structure, order), printed in zip(ORDERS.items(), MEANS, strict=True):
            ours = compiled_seconds(op, pv, structure)
            one_by_one = numpy_seconds(map_by_candidate, op, pv, structure)
            at_once = numpy_seconds(map_at_once, op, pv, structure)
            rows.append(
                (
                    samples,
                    order,
                    f"{ours:.3f}",
                    *(f"{each:.2f}, {each / ours:.1f} times" for each in (one_by_one, at_once)),
                    f"{printed:g}, {printed / ours:.0f} times",
                )
            )
    columns = (
        "samples",
        "process",
        "compiled, s",
        "NumPy valve by valve, s",
        "NumPy all at once, s",
        "paper's mean, s",
    )
    print(table("### The map of `lee2008`: 2601 valves, ten delays, CPU seconds", columns, rows))


def sticking_loop(seed: int, samples: int) -> tuple[FloatArray, FloatArray]:
    """Return OP and PV about its mean of a simulated loop, OP and PV units, shape (samples,)."""
    scenario = random_plant(seed, "stiction")
    record = simulate(scenario.model_copy(update={"duration": samples * scenario.ts}))
    return record.op, record.pv - record.pv.mean()


def compiled_seconds(op: FloatArray, pv: FloatArray, structure: int) -> float:
    bands = grid(float(np.ptp(op)))
    return seconds(lambda: output_errors(op, pv, bands, DELAYS, structure, 0, HE))


def numpy_seconds(
    numpy_map: NumpyMap, op: FloatArray, pv: FloatArray, structure: int, *, every: int = 1
) -> float:
    """Return the CPU time of a map in NumPy, s; from one valve in ``every`` where its time goes by valves."""
    bands = grid(float(np.ptp(op)))
    some = bands[::every]
    started = time.process_time()
    numpy_map(op, pv, some, DELAYS, structure)
    return (time.process_time() - started) * len(bands) / len(some)
