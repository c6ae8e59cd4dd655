"""Half an hour of six loops over real sockets: is memory flat, is any alarm false, is every true one told?"""

from __future__ import annotations

import asyncio
import gc
import os
import time
from collections import defaultdict
from pathlib import Path

import numpy as np
import yaml

from agent.cli.config_folder import config_folder
from agent.cli.stage import on_stage
from agent.runtime.workers import PoolExecutor
from benchmarks.markdown import table
from benchmarks.options import Options
from simulators.scenario import Scenario, load_scenario
from simulators.source import PlantSource

SPEED = 10.0
"""Times real time."""
LOOPS = ("fic101", "fic102", "fic103", "fic104", "lic201", "pic402")
MINUTES, SHORT = 30.0, 10.0
"""Of wall time, with --full and without."""
WARM = 0.4
"""Part of the time after which memory should no longer grow: windows are full and every kernel is loaded."""
GROWTH = 1.0
"""Most MB an hour that memory may grow after that."""
EVERY = 2.0
"""s"""


def run(options: Options) -> None:
    """Print a row for each loop, and what memory did."""
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
    told: dict[str, set[bool]] = defaultdict(set)
    verdicts: dict[str, list[str]] = defaultdict(list)
    memory: list[tuple[float, float]] = []
    async with (
        PoolExecutor(1) as executor,
        on_stage(
            sources,
            lambda source: {
                "window": plan["window"],
                "alarm": plan["alarm"],
                **_known(scenarios[source.loop]),
            },
            SPEED,
            executor,
            lambda diagnosis: verdicts[diagnosis.loop].append(diagnosis.verdict),
        ) as stage,
    ):
        began = time.monotonic()
        while (now := time.monotonic() - began) < seconds:
            await asyncio.sleep(EVERY)
            for loop, active in stage.told.items():
                told[loop].add(active)
            gc.collect()
            memory.append((now, resident()))
        samples = {status.loop: status.samples for status in stage.agent.status()}
    rows = [
        (name, scenario.truth.verdict, samples[name], len(verdicts[name]), _judged(scenario, told[name]))
        for name, scenario in scenarios.items()
    ]
    columns = ("loop", "truth", "samples", "windows", "alarm on its bus")
    print(table(f"### {seconds / 60:g} minutes over real sockets, {SPEED:g} times real time", columns, rows))
    times, sizes = np.array(memory)[int(WARM * len(memory)) :].T
    slope = 3600 * float(np.polyfit(times, sizes, 1)[0])
    holds = "holds" if slope <= GROWTH else "**does not hold**"
    print(f"Memory: {sizes[0]:.1f} MB when warm, {sizes[-1]:.1f} MB at the end, {slope:+.2f} MB/h: {holds}\n")


def resident() -> float:
    """Return the memory that this process has now, MB."""
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 1e6


def _known(scenario: Scenario) -> dict[str, object]:
    return {"acting": scenario.controller.acting, "op_range": list(scenario.op_range)}


def _judged(scenario: Scenario, told: set[bool]) -> str:
    if scenario.truth.verdict == "stiction":
        return "told" if True in told else "**not told**"
    return "**false alarm**" if True in told else "none"
