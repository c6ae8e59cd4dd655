"""100 to 10,000 loops over each bus into one agent, beside a bare client: CPU, memory, age, stops, loss.

The agent is a process of its own with its page and its workers, as ``slipjump run`` has it; every loop has
the diagnosis of a quiet window, so that a scrape is as large as after the first hour. A bare client of the
bus's library, that only makes numbers of what comes, reads the same server at the same time: CPU times are
compared within the run.
"""

from __future__ import annotations

import contextlib
import multiprocessing
import tempfile
import time
import urllib.request
from collections.abc import Iterator
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

import yaml

from agent.analysis.diagnose import diagnose
from agent.analysis.diagnosis import Diagnosis
from agent.analysis.routine import routine_diagnosis
from benchmarks.cases.options import Options
from benchmarks.looked_once import window_of
from benchmarks.plant.broker import free_port
from benchmarks.plant.buses import MODBUS, MQTT, OPCUA, Bus
from benchmarks.plant.memory import proportional
from benchmarks.plant.readers import WATCH, Read, agent
from benchmarks.plant.values import ROLES
from benchmarks.tables.markdown import table

SECONDS, FULL_SECONDS = 20.0, 600.0
"""Of measuring; as long again passes at most until all loops are read."""
SETTLED = 5.0
"""s from the first value of all loops to the mark from which CPU counts."""
LONGEST_START = 90.0
"""s until it is measured all the same: a machine with other work may never read all loops in time."""
SCRAPES = 3
WORKERS = 1
SEED = 8300
"""Of the quiet window."""
CONTEXT = multiprocessing.get_context("spawn")


def run(options: Options) -> None:
    """Print a table for each bus, with a row for each size."""
    seconds = FULL_SECONDS if options.full else SECONDS
    columns = (
        "loops",
        "CPU a value, us: agent, bare",
        "ratio",
        "agent's CPU, cores",
        "ms from source to window: median, 99 %, longest",
        "came, %: agent, bare",
        "lost",
        "memory, MB: agent, with workers",
        "start, s",
        "loop stood still, ms",
        "in a scrape, ms",
        "scrape: s, MB",
    )
    quiet = routine_diagnosis(window_of(SEED, "none_noise"), diagnose).diagnosis
    for bus in (MQTT, MODBUS, OPCUA):
        sizes = bus.sizes if options.loops is None else (options.loops,)
        rows = [measured(bus, size, seconds, quiet) for size in sizes]
        print(table(f"### {bus.name}: OP, PV and SP at 1 Hz, {seconds:.0f} s", columns, rows))


def measured(bus: Bus, count: int, seconds: float, quiet: Diagnosis) -> tuple[object, ...]:
    """Return the cells of a row."""
    names = [f"FIC{k:05d}" for k in range(count)]
    with contextlib.ExitStack() as stack:
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory()))
        port, page = stack.enter_context(bus.serve(folder, names)), free_port()
        config = configuration(folder, names, bus, port, page)
        began = time.perf_counter()
        agent_says, watched = stack.enter_context(child(agent, config, quiet))
        client_says, _ = stack.enter_context(child(bus.bare, port, names))
        while asked(agent_says).values < count and time.perf_counter() - began < LONGEST_START:
            time.sleep(0.5)
        start = time.perf_counter() - began
        time.sleep(SETTLED)
        marks = agent_says, client_says
        for each in marks:
            asked(each)
        time.sleep(seconds)
        client, read = asked(client_says), asked(agent_says, WATCH)
        time.sleep(seconds / 2)
        watched_read = asked(agent_says, WATCH)
        memory = proportional(watched.pid or 0)
        scrapes = [_scrape(page) for _ in range(SCRAPES)]
        scraped = asked(agent_says)
    took, size = (max(each[k] for each in scrapes) for k in (0, 1))
    return (
        count,
        f"{1e6 * read.value_cost:.1f}, {1e6 * client.value_cost:.1f}",
        f"{read.value_cost / client.value_cost:.2f}",
        f"{read.cpu / read.wall:.2f}",
        ", ".join(f"{1000 * each:.0f}" for each in read.delays),
        ", ".join(f"{100 * each.values / (len(ROLES) * count * each.wall):.0f}" for each in (read, client)),
        read.lost,
        ", ".join(f"{each:.0f}" for each in memory),
        f"{start:.1f}",
        f"{1000 * watched_read.stops[-1]:.0f}",
        f"{1000 * scraped.stops[-1]:.0f}",
        f"{took:.2f}, {size / 1e6:.1f}",
    )


def configuration(folder: Path, names: list[str], bus: Bus, port: int, page: int) -> Path:
    """Write the configuration of a plant and return its path."""
    rows = [",".join([name, *(bus.cell(k, name, role) for role in ROLES)]) for k, name in enumerate(names)]
    (folder / "loops.csv").write_text("\n".join([",".join(["name", *ROLES]), *rows]) + "\n")
    config = folder / "plant.yaml"
    defaults = {"connection": "bus", "ts": 1.0, "tags": {role: dict(bus.tags) for role in ROLES}}
    settings = {
        "agent": {"workers": WORKERS, "http": {"port": page}},
        "connections": {"bus": bus.connection(port)},
        "loops": [{"from": "loops.csv", "defaults": defaults}],
    }
    config.write_text(yaml.safe_dump(settings))
    return config


@contextlib.contextmanager
def child(main: Any, *args: Any) -> Iterator[tuple[Connection, Any]]:  # noqa: ANN401
    """Run a reader in a process of its own; yield where it answers, and it."""
    here, there = CONTEXT.Pipe()
    process = CONTEXT.Process(target=main, args=(*args, there))
    process.start()
    try:
        yield here, process
    finally:
        with contextlib.suppress(OSError):
            here.send(None)
        process.join(20)
        process.kill()


def asked(says: Connection, send: str | bool = True) -> Read:  # noqa: FBT001, FBT002 - what a mark is
    """Return what a reader says of the time since the last mark."""
    says.send(send)
    found: Read = says.recv()
    return found


def _scrape(port: int) -> tuple[float, int]:
    began = time.perf_counter()
    with urllib.request.urlopen(f"http://127.0.0.1:{port}/metrics", timeout=60) as answer:
        size = len(answer.read())
    return time.perf_counter() - began, size
