"""Half an hour of six loops over real sockets: is memory flat, is any alarm false, is every true one sent?

The plants, their servers and the consumers of the alarms are here; `slipjump run` is a process of its own, as
a user has it, so that its memory is measured apart from theirs.
"""

from __future__ import annotations

import asyncio
import contextlib
import os
import signal
import sys
import tempfile
import time
from collections import defaultdict
from pathlib import Path

import numpy as np
import yaml

from agent.cli.common.config_folder import config_folder
from benchmarks.cases.options import Options
from benchmarks.tables.markdown import table
from simulators.clock import Clock
from simulators.player import play
from simulators.scenario import Scenario, load_scenario
from simulators.servers.broker import embedded_broker
from simulators.servers.loop_server import LoopServer, roles_of
from simulators.servers.modbus import ModbusServer
from simulators.servers.mqtt import MqttServer
from simulators.servers.opcua import OpcUaServer
from simulators.source import PlantSource

SPEED = 10.0
"""Times real time."""
LOOPS = ("fic101", "fic102", "fic103", "fic104", "lic201", "pic402")
MINUTES, SHORT = 30.0, 10.0
"""Of wall time, with --full and without."""
WARM = 0.4
"""Part of the time after which memory should no longer grow: windows are full and every kernel is loaded."""
GROWTH = 1.0
"""Most MB an hour that the daemon's memory may grow after that."""
EVERY = 2.0
"""s"""
PAGE = os.sysconf("SC_PAGE_SIZE") / 1e6
"""MB"""


def run(options: Options) -> None:
    """Print a row for each loop, and the course of memory."""
    minutes = MINUTES if options.full else SHORT
    asyncio.run(_soak(60 * minutes))


async def _soak(seconds: float) -> None:
    folder = config_folder()
    plan = yaml.safe_load((folder / "demo.yaml").read_text(encoding="utf-8"))
    scenarios = {}
    sources = defaultdict(list)
    for entry in plan["loops"]:
        if entry["scenario"].partition("_")[0] in LOOPS:
            scenario = load_scenario(folder / "scenarios" / entry["scenario"])
            scenario = scenario.model_copy(update={"duration": 1.2 * seconds * SPEED})
            scenarios[scenario.loop] = scenario
            sources[entry["bus"]].append(PlantSource(scenario))
    published: dict[str, set[bool]] = defaultdict(set)
    memory: list[tuple[float, float, float]] = []
    async with contextlib.AsyncExitStack() as stack:
        broker = await stack.enter_async_context(embedded_broker())
        kinds = {"modbus": ModbusServer, "opcua": OpcUaServer}
        servers: dict[str, LoopServer] = {
            bus: await stack.enter_async_context(
                kinds[bus](roles_of(loops)) if bus in kinds else MqttServer(roles_of(loops), port=broker)
            )
            for bus, loops in sources.items()
        }
        work = Path(stack.enter_context(tempfile.TemporaryDirectory()))
        entries = [
            servers[bus].loop_settings(source.loop, source.ts)
            | {"window": plan["window"], "alarm": plan["alarm"]}
            | _known(scenarios[source.loop])
            for bus, loops in sources.items()
            for source in loops
        ]
        config = {
            # plants have a time of their own
            "agent": {"clock_error": None, "workers": 1, "state": str(work / "state.sqlite")},
            "connections": {server.name: server.connection_settings() for server in servers.values()},
            "loops": entries,
        }
        (work / "soak.yaml").write_text(yaml.safe_dump(config), encoding="utf-8")
        log = stack.enter_context((work / "log.jsonl").open("wb"))
        daemon = await asyncio.create_subprocess_exec(
            sys.executable, "-c", "from agent.cli import main; main()", "run", str(work / "soak.yaml"),
            "--log-format", "json", stderr=log,
        )  # fmt: skip
        try:
            tasks = [asyncio.create_task(_watch(server, published)) for server in servers.values()]
            tasks += [
                asyncio.create_task(play(loops, servers[bus], Clock(SPEED))) for bus, loops in sources.items()
            ]
            began = time.monotonic()
            while (now := time.monotonic() - began) < seconds:
                await asyncio.sleep(EVERY)
                memory.append((now, resident(daemon.pid), sum(map(resident, below(daemon.pid)))))
                if now % 60 < EVERY:
                    print(
                        f"{now / 60:4.0f} min {memory[-1][1]:8.1f} {memory[-1][2]:8.1f} MB", file=sys.stderr
                    )
                for task in tasks:
                    if task.done():
                        task.result()
        finally:
            with contextlib.suppress(ProcessLookupError):
                daemon.send_signal(signal.SIGTERM)
            await daemon.wait()
            for task in tasks:
                task.cancel()
            await asyncio.wait(tasks)
        lines = (work / "log.jsonl").read_text(encoding="utf-8").splitlines()
    rows = [
        (
            name,
            scenario.truth.verdict,
            sum(f'"event": "diagnosis", "loop": "{name}"' in line for line in lines),
            _judged(scenario, published[name]),
        )
        for name, scenario in scenarios.items()
    ]
    columns = ("loop", "truth", "windows", "alarm on its bus")
    print(table(f"### {seconds / 60:g} minutes over real sockets, {SPEED:g} times real time", columns, rows))
    times, own, workers = np.array(memory)[int(WARM * len(memory)) :].T
    for name, sizes in (("the daemon", own), ("its workers and fork server", workers)):
        slope = 3600 * float(np.polyfit(times, sizes, 1)[0])
        holds = "holds" if slope <= GROWTH else "**does not hold**"
        sizes_text = f"{sizes[0]:.1f} MB when warm, {sizes[-1]:.1f} MB at the end, {slope:+.2f} MB/h"
        print(f"Memory of {name}: {sizes_text}: {holds}\n")


def resident(process: int) -> float:
    """Return the memory that a process has now, MB."""
    try:
        return int(Path(f"/proc/{process}/statm").read_text(encoding="ascii").split()[1]) * PAGE
    except (FileNotFoundError, ProcessLookupError):
        return 0.0


def below(process: int) -> list[int]:
    """Return the processes that a process started, and those that they started."""
    try:
        children = Path(f"/proc/{process}/task/{process}/children").read_text(encoding="ascii").split()
    except (FileNotFoundError, ProcessLookupError):
        return []
    return [each for child in children for each in (int(child), *below(int(child)))]


async def _watch(server: LoopServer, published: dict[str, set[bool]]) -> None:
    async for loop, active in server.watch_alarms():
        published[loop].add(active)


def _known(scenario: Scenario) -> dict[str, object]:
    return {"acting": scenario.controller.acting, "op_range": list(scenario.op_range)}


def _judged(scenario: Scenario, published: set[bool]) -> str:
    if scenario.truth.verdict == "stiction":
        return "published" if True in published else "**not published**"
    return "**false alarm**" if True in published else "none"
