"""Runs a plant, an agent and bare clients, each a process, and reads what they report."""

from __future__ import annotations

import contextlib
import multiprocessing
import time
import urllib.request
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

import yaml

from agent.analysis.diagnose import diagnose
from agent.analysis.diagnosis import Diagnosis
from agent.analysis.routine import routine_diagnosis
from benchmarks.looked_once import window_of
from benchmarks.plant.buses import Bus
from benchmarks.plant.marks import Read
from benchmarks.plant.values import ROLES

LONGEST_START = 90.0
"""s until it is measured all the same: a machine with other work may never read all loops in time."""
SEED = 8301
"""Of the quiet window."""
CONTEXT = multiprocessing.get_context("spawn")


@dataclass(frozen=True)
class Served:
    """Loops that a bus serves."""

    bus: Bus
    port: int
    names: list[str]


def quiet_diagnosis() -> Diagnosis:
    """Return the diagnosis of a window in which nothing happens."""
    return routine_diagnosis(window_of(SEED, "none_noise"), diagnose).diagnosis


def configuration(folder: Path, plant: Sequence[Served], page: int, workers: int) -> Path:
    """Write the configuration of an agent that reads all of the plant, and return its path."""
    settings: dict[str, Any] = {"agent": {"workers": workers, "http": {"port": page}}}
    settings["connections"] = {each.bus.key: each.bus.connection(each.port) for each in plant}
    settings["loops"] = []
    for each in plant:
        bus = each.bus
        rows = [[name, *(bus.cell(k, name, role) for role in ROLES)] for k, name in enumerate(each.names)]
        (folder / f"{bus.key}.csv").write_text("\n".join(map(",".join, [["name", *ROLES], *rows])) + "\n")
        defaults = {"connection": bus.key, "ts": 1.0, "tags": {role: dict(bus.tags) for role in ROLES}}
        settings["loops"].append({"from": f"{bus.key}.csv", "defaults": defaults})
    config = folder / "plant.yaml"
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


def until_all_came(says: Connection, values: int) -> None:
    """Return when a reader has got so many values since the last mark, or it took too long."""
    began, came = time.perf_counter(), 0
    while came < values and time.perf_counter() - began < LONGEST_START:
        time.sleep(0.5)
        came += asked(says).values


def scrape(page: int) -> tuple[float, int]:
    """Return how long a look at all metrics took, s, and its bytes."""
    began = time.perf_counter()
    with urllib.request.urlopen(f"http://127.0.0.1:{page}/metrics", timeout=60) as answer:
        size = len(answer.read())
    return time.perf_counter() - began, size
