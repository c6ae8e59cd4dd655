"""100 to 10,000 loops over each bus into one agent, beside a bare client: CPU, memory, age, stops, loss.

The agent is a process of its own with its page and its workers, as ``slipjump run`` has it; every loop has
the diagnosis of a quiet window, so that a scrape is as large as after the first hour. A bare client of the
bus's library, that only makes numbers of what comes, reads the same server at the same time: CPU times are
compared within the run. ``--save FILE.csv`` keeps the numbers and draws CPU against loops beside them.
"""

from __future__ import annotations

import contextlib
import tempfile
import time
from collections.abc import Iterable
from pathlib import Path

import numpy as np

from agent.analysis.diagnosis import Diagnosis
from benchmarks.cases.options import Options
from benchmarks.plant.broker import free_port
from benchmarks.plant.buses import BUSES, Bus
from benchmarks.plant.cpu_picture import Cost, kept, picture
from benchmarks.plant.marks import WATCH
from benchmarks.plant.memory import proportional
from benchmarks.plant.readers import agent
from benchmarks.plant.running import (
    Served,
    asked,
    child,
    configuration,
    quiet_diagnosis,
    scrape,
    until_all_came,
)
from benchmarks.plant.values import ROLES
from benchmarks.tables.markdown import table

SECONDS, FULL_SECONDS = 20.0, 600.0
"""Of measuring; as long again passes at most until all loops are read."""
SIZES = (100, 300, 1000, 3000, 10_000)
FIRST = 10.0
"""s from the first value on that are the start."""
SCRAPES = 3
WORKERS = 1
COLUMNS = (
    "loops",
    "CPU a value, us: agent, bare",
    "ratio",
    "agent's CPU, cores",
    "first 10 s, times as much",
    "ms from source to window: median, 99 %, longest",
    "came, %: agent, bare",
    "lost",
    "memory, MB: agent, with workers",
    "start, s",
    "loop stood still, ms",
    "in a scrape, ms",
    "scrape: s, MB",
)


def run(options: Options) -> None:
    """Print a table for each bus, with a row for each size."""
    seconds = options.seconds or (FULL_SECONDS if options.full else SECONDS)
    sizes = SIZES if options.loops is None else (options.loops,)
    quiet, costs = quiet_diagnosis(), list[Cost]()
    for bus in BUSES:
        rows = []
        for size in sizes:
            cells, cost = measured(bus, size, seconds, quiet)
            rows.append(cells)
            costs.append(cost)
        print(table(f"### {bus.name}: OP, PV and SP at 1 Hz, {seconds:.0f} s", COLUMNS, rows), flush=True)
        print(flatness([each for each in costs if each.bus == bus.key]), flush=True)
    if options.save is not None:
        kept(costs, options.save)
        picture(costs, options.save.with_suffix(".svg"))


def measured(bus: Bus, count: int, seconds: float, quiet: Diagnosis) -> tuple[tuple[object, ...], Cost]:
    """Return the cells of a row, and what the loops cost."""
    names = [f"FIC{k:05d}" for k in range(count)]
    with contextlib.ExitStack() as stack:
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory()))
        port, page = stack.enter_context(bus.serve(folder, names)), free_port()
        config = configuration(folder, [Served(bus, port, names)], page, WORKERS)
        began = time.perf_counter()
        agent_says, watched = stack.enter_context(child(agent, config, quiet))
        client_says, _ = stack.enter_context(child(bus.bare, port, names))
        until_all_came(agent_says, 1)
        time.sleep(FIRST)
        first = asked(agent_says)
        if first.values < count:
            until_all_came(agent_says, count)
        start = time.perf_counter() - began - FIRST
        for each in (agent_says, client_says):
            asked(each)
        time.sleep(seconds)
        client, read = asked(client_says), asked(agent_says, WATCH)
        time.sleep(seconds / 2)
        watched_read = asked(agent_says, WATCH)
        memory = proportional(watched.pid or 0)
        scrapes = [scrape(page) for _ in range(SCRAPES)]
        scraped = asked(agent_says)
    took, size = (max(each[k] for each in scrapes) for k in (0, 1))
    cells = (
        count,
        f"{1e6 * read.value_cost:.1f}, {1e6 * client.value_cost:.1f}",
        f"{read.value_cost / client.value_cost:.2f}",
        f"{read.cpu / read.wall:.3f}",
        f"{first.cpu / first.wall / (read.cpu / read.wall):.1f}",
        in_ms(read.delays),
        ", ".join(f"{100 * each.values / (len(ROLES) * count * each.wall):.0f}" for each in (read, client)),
        read.lost,
        ", ".join(f"{each:.0f}" for each in memory),
        f"{start:.1f}",
        f"{1000 * watched_read.longest_stop:.0f}",
        f"{1000 * scraped.longest_stop:.0f}",
        f"{took:.2f}, {size / 1e6:.1f}",
    )
    return cells, Cost(bus.key, count, read.cpu / read.wall, client.cpu / client.wall)


def in_ms(delays: Iterable[float]) -> str:
    """Return median, 99 % and longest of delays (s), in ms; empty where there are none."""
    there = np.fromiter(delays, float)
    return (
        ", ".join(f"{1000 * each:.0f}" for each in np.quantile(there, [0.5, 0.99, 1.0])) if len(there) else ""
    )


def flatness(costs: list[Cost]) -> str:
    """Return what a loop costs at each size, in a line."""
    each = [1e6 * cost.agent / cost.loops for cost in costs]
    words = ", ".join(f"{cost.loops}: {us:.0f}" for cost, us in zip(costs, each, strict=True))
    return (
        f"CPU of a loop, us each second: {words}. The largest over the least: {max(each) / min(each):.2f}.\n"
    )
