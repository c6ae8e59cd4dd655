"""Wall time of ``diagnose`` of many files with its table, against the sum of the fits on all cores."""

from __future__ import annotations

import json
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


def run(options: Options) -> None:
    """Print the ratio: 1 is what perfect sharing among the cores would need, start-up and report included.

    The fits and the wall time are of one run, so that what else the machine does slows both.
    """
    del options
    with tempfile.TemporaryDirectory() as folder:
        files = []
        for k in range(FILES):
            scenario = random_plant(SEED + k, KINDS[k % len(KINDS)])
            file = Path(folder) / f"LOOP{k:02}.csv"
            write_rows(file, rows(scenario))
            files.append(str(file))
        subprocess.run([sys.executable, "-c", MAIN, "warm"], check=True, capture_output=True)  # noqa: S603 - our own command
        report = str(Path(folder) / "plant.html")
        words = [sys.executable, "-c", MAIN, "diagnose", *files, "--json", "--report", report]
        started = time.perf_counter()
        answers = subprocess.run(words, check=True, capture_output=True, text=True).stdout  # noqa: S603 - our own command
        wall = time.perf_counter() - started
    fits = [json.loads(line)["seconds"] for line in answers.splitlines()]
    whole = sum(fits)
    numbers = (f"{whole:.1f}", f"{max(fits):.1f}", f"{wall:.1f}", f"{wall * cores() / whole:.2f}")
    own = (str(FILES), str(cores()), *numbers)
    columns = (
        "files", "cores", "sum of fits, s", "longest fit, s", "wall with report, s", "wall x cores / fits",
    )  # fmt: skip
    print(table("### `diagnose` of many files", columns, [own]))
