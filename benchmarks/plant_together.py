"""One agent reads OPC UA, Modbus and MQTT together, a third of the loops each, for some minutes.

First bare clients of all three read the same servers meanwhile, for the ratio of CPU. Then they end, and the
agent is watched alone: age of values in windows, values that did not come, memory with all workers. Windows
begin empty, so all of 300 s come due at once, as after any start; each tenth loop swings and has fits.
"""

from __future__ import annotations

import contextlib
import tempfile
import time
from collections.abc import Sequence
from multiprocessing.connection import Connection
from pathlib import Path

import numpy as np

from agent.runtime.capabilities import cores
from benchmarks.cases.options import Options
from benchmarks.plant.broker import free_port
from benchmarks.plant.buses import BUSES
from benchmarks.plant.marks import WATCH, Read
from benchmarks.plant.memory import proportional, workers_cpu
from benchmarks.plant.readers import agent
from benchmarks.plant.running import Served, asked, child, configuration, quiet_diagnosis, until_all_came
from benchmarks.plant.values import ROLES
from benchmarks.plant_scale import in_ms
from benchmarks.tables.markdown import table

LOOPS = 10_000
SECONDS, FULL_SECONDS = 60.0, 600.0
STRETCHES = 10
"""Rows of the table."""
BESIDE = 30.0
"""Longest time that the bare clients read beside the agent, s."""
SETTLED = 10.0
"""s from the first value of all loops to the first mark."""
COLUMNS = (
    "s",
    "agent's CPU, cores",
    "workers'",
    *(f"ms to window, {each.key}: median, 99 %, longest" for each in BUSES),
    *(f"came, %, {each.key}" for each in BUSES),
    "lost",
    "looks, fits",
    "loop stood still, ms",
    "memory, MB: agent, with workers",
)


def run(options: Options) -> None:
    """Print the ratio, a table with a row for each tenth of the time, and a line about all of it."""
    count = options.loops or LOOPS
    seconds = options.seconds or (FULL_SECONDS if options.full else SECONDS)
    with contextlib.ExitStack() as stack:
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory()))
        plant = []
        for k, bus in enumerate(BUSES):
            names = [f"FIC{number:05d}" for number in range(k, count, len(BUSES))]
            plant.append(Served(bus, stack.enter_context(bus.serve(folder, names)), names))
        config = configuration(folder, plant, free_port(), cores())
        says, process = stack.enter_context(child(agent, config, quiet_diagnosis()))
        until_all_came(says, 2 * count * len(ROLES))
        print(beside_bare_clients(says, plant, min(BESIDE, seconds)), flush=True)
        rows, reads, most = [], list[Read](), 0.0
        for k in range(STRETCHES):
            before = workers_cpu(process.pid)
            time.sleep(seconds / STRETCHES)
            busy, memory = workers_cpu(process.pid) - before, proportional(process.pid)
            read, most = asked(says, WATCH), max(most, memory[1])
            reads.append(read)
            rows.append(stretch(round((k + 1) * seconds / STRETCHES), read, busy, memory, plant))
    print(table(f"### {count} loops on three buses, OP, PV and SP at 1 Hz", COLUMNS, rows))
    print(summary(reads, count, most))


def beside_bare_clients(says: Connection, plant: Sequence[Served], seconds: float) -> str:
    """Return the ratio of the agent's CPU to that of bare clients of the three buses together."""
    with contextlib.ExitStack() as stack:
        clients = [stack.enter_context(child(each.bus.bare, each.port, each.names))[0] for each in plant]
        for client, each in zip(clients, plant, strict=True):
            until_all_came(client, len(each.names) * len(ROLES))
        time.sleep(SETTLED)
        for each in (says, *clients):
            asked(each)
        time.sleep(seconds)
        read, *bare = [asked(each) for each in (says, *clients)]
    used = sum(each.cpu / each.wall for each in bare)
    agents = read.cpu / read.wall
    names = ", ".join(
        f"{each.bus.name} {found.cpu / found.wall:.3f}" for each, found in zip(plant, bare, strict=True)
    )
    return (
        f"Beside bare clients, {seconds:.0f} s: agent {agents:.3f} cores, bare clients {used:.3f} ({names}): "
        f"ratio {agents / used:.2f}.\n"
    )


def stretch(
    until: int, read: Read, busy: float, memory: tuple[float, float], plant: Sequence[Served]
) -> tuple[object, ...]:
    """Return the cells of a row."""
    came = (
        100 * read.values_of.get(each.bus.key, 0) / (len(ROLES) * len(each.names) * read.wall)
        for each in plant
    )
    return (
        until,
        f"{read.cpu / read.wall:.2f}",
        f"{busy / read.wall:.2f}",
        *(in_ms(read.delays_of.get(each.bus.key, ())) for each in plant),
        *(f"{each:.1f}" for each in came),
        read.lost,
        f"{read.looks}, {read.fits}",
        f"{1000 * read.longest_stop:.0f}",
        ", ".join(f"{each:.0f}" for each in memory),
    )


def summary(reads: Sequence[Read], count: int, memory: float) -> str:
    """Return a line about all of the time."""
    delays = np.concatenate([each.delays for each in reads])
    wall, values = sum(each.wall for each in reads), sum(each.values for each in reads)
    middle, late = np.quantile(delays, [0.5, 0.99])
    return (
        f"In {wall:.0f} s: from source to window {1000 * middle:.0f} ms in the median, "
        f"{1000 * late:.0f} at 99 % of {len(delays)} that were watched, {1000 * delays.max():.0f} at most; "
        f"{100 * values / (len(ROLES) * count * wall):.2f} % of the values came, "
        f"{sum(each.lost for each in reads)} were discarded; {memory:.0f} MB with all workers at most; "
        f"{sum(each.cpu for each in reads) / wall:.2f} cores for the agent, "
        f"{sum(each.looks for each in reads)} windows, {sum(each.fits for each in reads)} fits."
    )
