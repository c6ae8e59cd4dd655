"""Wall time of ``diagnose`` of many files with its table, against the sum of the fits on all cores."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from agent.runtime.capabilities import cores
from benchmarks.cases.options import Options
from benchmarks.tables.markdown import table
from simulators.draws.random_plants import random_plant
from simulators.plant import rows
from simulators.record_file import write_rows

FILES = 31
SEED = 8300
"""First of the loops; nothing was set on them."""
KINDS = ("stiction", "tuning", "none_noise")
MAIN = "from agent.cli import main; main()"
NO_BYTECODE = "PYTHONDONTWRITEBYTECODE"
"""Where it is set, each process of a checkout compiles 300 sources anew (0.6 s), one of an installed package
none."""


def run(options: Options) -> None:
    """Print the ratio: 1 is what perfect sharing among the cores would need, start-up and report included.

    The fits and the wall time are of one run, so that what else the machine does slows both.
    """
    del options
    environment = {name: value for name, value in os.environ.items() if name != NO_BYTECODE}
    with tempfile.TemporaryDirectory() as folder:
        files = []
        for k in range(FILES):
            scenario = random_plant(SEED + k, KINDS[k % len(KINDS)])
            file = Path(folder) / f"LOOP{k:02}.csv"
            write_rows(file, rows(scenario))
            files.append(str(file))
        start = [sys.executable, "-c", MAIN]

        def command(*words: str) -> str:
            return subprocess.run(  # noqa: S603 - our own command
                [*start, *words], check=True, capture_output=True, text=True, env=environment
            ).stdout

        command("warm")
        report = str(Path(folder) / "plant.html")
        command("diagnose", *files[:2], "--json", "--report", report)
        started = time.perf_counter()
        answers = command("diagnose", *files, "--json", "--report", report)
        wall = time.perf_counter() - started
    fits = [json.loads(line)["seconds"] for line in answers.splitlines()]
    whole = sum(fits)
    numbers = (f"{whole:.1f}", f"{max(fits):.1f}", f"{wall:.1f}", f"{wall * cores() / whole:.2f}")
    own = (str(FILES), str(cores()), *numbers)
    columns = (
        "files", "cores", "sum of fits, s", "longest fit, s", "wall with report, s", "wall x cores / fits",
    )  # fmt: skip
    print(table("### `diagnose` of many files", columns, [own]))
